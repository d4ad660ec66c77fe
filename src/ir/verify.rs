//! States what a program promises.
