//! What all of this process holds on the heap: counted, and bounded where a test asks for it.

use std::alloc::System;

use cap::Cap;

/// The allocator of all tests.
#[global_allocator]
pub static HEAP: Cap<System> = Cap::new(System, usize::MAX);
