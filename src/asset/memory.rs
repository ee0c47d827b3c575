//! Memory that is left, asked before anything large is allocated.

use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use super::flaw::Flaw;

use crate::text::bytes;

/// Less than this is not worth a question to the operating system.
const SMALL: u64 = 1 << 20;

/// Memory that may be used.
#[derive(Clone, Copy, Debug, Default)]
pub struct Memory {
    most: Option<u64>,
}

impl Memory {
    /// As much as the system gives, and at most `most` bytes for the whole process.
    pub fn at_most(most: Option<u64>) -> Self {
        Self { most }
    }

    /// Bytes that may still be allocated: the least of what is free, what the control groups and the limit of the
    /// address space leave, and what is left of the bound; `None` where the system tells nothing.
    pub fn left(&self) -> Option<u64> {
        let within = |(limit, used): (u64, u64)| limit.saturating_sub(used);
        let own = self.most.map(|most| within((most, process("VmRSS:").unwrap_or(0))));
        let address_space = address_space().zip(process("VmSize:")).map(within);
        [own, free(), control_groups(), address_space].into_iter().flatten().min()
    }

    /// Refuses what needs more than is left.
    ///
    /// # Errors
    /// Names `what` and both sizes.
    pub fn check(&self, what: impl Display, needed: u64) -> Result<(), Flaw> {
        match self.left() {
            Some(left) if needed > left.max(SMALL) => Err(Flaw::new(
                format!("{what} needs {} of memory, and {} are left", bytes(needed), bytes(left)),
                "use a smaller one, free some memory, or allow more with --max-memory",
            )),
            _ => Ok(()),
        }
    }
}

/// Bytes of physical memory that are free or can be made so.
fn free() -> Option<u64> {
    let memory = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    Some(System::new_with_specifics(memory).available_memory()).filter(|free| *free > 0)
}

/// A size that Linux tells of this process.
fn process(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes << 10)
}

/// The limit of the address space, if there is one.
fn address_space() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Bytes that the control groups of this process and those above them leave.
fn control_groups() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    groups.lines().filter_map(control_group).min()
}

/// Bytes that a line `hierarchy:controllers:/path` leaves.
fn control_group(line: &str) -> Option<u64> {
    let mut parts = line.splitn(3, ':').skip(1);
    let (controllers, path) = (parts.next()?, parts.next()?);
    let (root, limit, usage) = match controllers {
        "" => ("/sys/fs/cgroup", "memory.max", "memory.current"),
        "memory" => ("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes"),
        _ => return None,
    };
    let own = Path::new(root).join(path.trim_start_matches('/'));
    let groups = own.ancestors().take_while(|group| group.starts_with(root));
    groups.filter_map(|group| left_in(group.to_owned(), limit, usage)).min()
}

/// Bytes that one control group leaves; `None` for a group without a limit.
fn left_in(group: PathBuf, limit: &str, usage: &str) -> Option<u64> {
    let read = |name: &str| fs::read_to_string(group.join(name)).ok();
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    // Cached files count as used, but give way.
    let cached = read("memory.stat").and_then(|stat| {
        let line = stat.lines().find_map(|line| line.strip_prefix("inactive_file "))?;
        line.trim().parse().ok()
    });
    Some(number(limit)?.saturating_sub(number(usage)?.saturating_sub(cached.unwrap_or(0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_both_sizes() {
        let message = Memory::at_most(Some(1)).check("a sky of 8 × 4", 3 << 30).unwrap_err().problem;
        assert!(message.contains("a sky of 8 × 4 needs 3.00 GiB") && message.contains("0 B"), "{message}");
        assert!(Memory::default().check("all", u64::MAX).is_err());
        assert_eq!(Memory::default().check("little", 1000), Ok(()));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_least_limit_counts() {
        let used = process("VmRSS:").unwrap();
        assert!(used > 0 && process("VmSize:").unwrap() > used);
        let all = Memory::default().left().unwrap();
        let some = Memory::at_most(Some(used + (64 << 20))).left().unwrap();
        assert!(some <= 64 << 20 && some <= all, "{some} {all}");
    }

    #[test]
    fn a_control_group_leaves_its_limit_less_what_is_used() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        let left = || left_in(folder.path().to_owned(), "max", "current");
        assert_eq!(left(), None);
        write("max", "max\n");
        write("current", "300\n");
        assert_eq!(left(), None);
        write("max", "1000\n");
        assert_eq!(left(), Some(700));
        write("memory.stat", "anon 100\ninactive_file 200\n");
        assert_eq!(left(), Some(900));
    }
}
