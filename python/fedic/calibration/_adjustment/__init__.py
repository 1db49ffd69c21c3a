"""Bundle adjustment: the least-squares fit of lens and poses to the points of a target."""
