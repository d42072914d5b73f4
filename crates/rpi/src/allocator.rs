//! Settings of the allocator of the C library for a server.
//!
//! By default glibc raises the size from which on an allocation is returned to the system when it is freed, up to 32 MiB,
//! after the first large one is freed, and has eight arenas per processor. A server whose clients had sent large messages
//! then kept 500 MB that nothing used. The settings are variables of the environment that are read at the start of a
//! process, so the process starts its program again. A function of the C library for them (`mallopt`) needs `unsafe`.

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod glibc {
    use std::os::unix::process::CommandExt;
    use std::process::Command;

    use crate::own_program::own_program;

    /// Settings: an allocation from 128 KiB on is returned to the system when it is freed, and all threads share two
    /// arenas. The value of a variable that is set already is kept.
    const SETTINGS: [(&str, &str); 2] = [
        ("MALLOC_MMAP_THRESHOLD_", "131072"),
        ("MALLOC_ARENA_MAX", "2"),
    ];

    /// Starts this program again in this process with the settings, if they are missing. Returns if they are there, or if
    /// the program cannot be started again: it then only uses more memory.
    pub(crate) fn return_memory_early() {
        let missing = SETTINGS
            .iter()
            .filter(|(name, _)| std::env::var_os(name).is_none());
        let missing: Vec<_> = missing.copied().collect();
        let mut arguments = std::env::args_os();
        let name = arguments.next();
        if let (false, Some(name), Ok(program)) = (missing.is_empty(), name, own_program()) {
            let _failed = Command::new(program)
                .arg0(name)
                .args(arguments)
                .envs(missing)
                .exec();
        }
    }
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub(crate) use glibc::return_memory_early;

/// Does nothing: the settings are those of glibc.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(crate) fn return_memory_early() {}
