"""A challenge of the project's own: machines with concealed effects, made by a program that shares no physics."""
