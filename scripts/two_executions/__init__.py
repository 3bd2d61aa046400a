"""The Drake Diagram beside the compiled rollout (`agreement.py`)."""
