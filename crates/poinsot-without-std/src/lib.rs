//! Every kernel that works without the standard library is called once at many states of a satellite with an arm: by the
//! test of this package, which has no code of its own.
//!
//! A package of its own, since tests of `poinsot-dynamics` itself need crates that switch its feature `std` on.
#![no_std]
