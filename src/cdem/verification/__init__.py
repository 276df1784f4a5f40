"""Problems with a known answer, and the manual that compares them."""
