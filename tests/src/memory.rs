//! How much memory this process has, as far as the system tells.

/// In use now, bytes; 0 where nobody tells.
pub fn resident() -> u64 {
    of_status("VmRSS:")
}

/// The most there ever was, bytes; 0 where nobody tells.
pub fn peak() -> u64 {
    of_status("VmHWM:")
}

fn of_status(name: &str) -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default();
    1024 * line.trim().trim_end_matches("kB").trim().parse().unwrap_or(0)
}
