"""What is told: report, page, terminal."""
