"""The science. Never imports bpy; everything here runs in a plain Python process."""
