//! Verbs of the applications of structures.
