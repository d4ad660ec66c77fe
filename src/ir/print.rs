//! Shows a program as text.
