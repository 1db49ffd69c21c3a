"""Mutated files of every kind that fedic reads: each must give a value or a `fedic.FedicError`, soon."""
