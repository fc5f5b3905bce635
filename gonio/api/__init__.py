"""gonio from Python: plans, sessions, samples and materials with what the command line does.

`gonio` offers `Plan`, `Session`, `Samples` and `Material` of here. The command line calls the
same functions, so that both come to the same files, to the bit.
"""
