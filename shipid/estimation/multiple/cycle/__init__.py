"""One cycle of a multiple-model filter: its vectors, the mixing of modes, their maps and moves, and the generated function."""
