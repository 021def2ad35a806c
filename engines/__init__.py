"""The science. Never imports bpy; everything here runs in a plain Python process."""

VERSION = "0.1.0"
