//! What all of this process holds on the heap: counted, and bounded where a test asks for it.

use std::alloc::System;
use std::process::Command;

use cap::Cap;

/// The allocator of all tests.
#[global_allocator]
pub static HEAP: Cap<System> = Cap::new(System, usize::MAX);

/// Runs the test of this module path alone in a process of its own, so that other tests' memory is not counted; true in
/// that process.
pub fn is_alone(test: &str) -> bool {
    const ALONE: &str = "WARPFRONT_TEST_ALONE";
    if std::env::var_os(ALONE).is_some() {
        return true;
    }
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--include-ignored", "--nocapture", "--exact", test]).env(ALONE, "1");
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && said.contains("1 passed"),
        "{said}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    false
}
