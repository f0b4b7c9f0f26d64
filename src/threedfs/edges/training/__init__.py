"""How the contour detector learns: pictures whose contours are known, and trees grown from them."""
