"""Space frames: gridshells and façades, analysed, checked and sized member by member."""
