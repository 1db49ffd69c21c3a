"""Small mesh files in many variants of the formats that fedic reads."""
