"""Sun and sky: where the sun stands, what the weather lets through, and what it lights."""
