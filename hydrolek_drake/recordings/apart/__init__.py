"""Readers that run in a process of their own, since what they read may crash, hang or outgrow them."""
