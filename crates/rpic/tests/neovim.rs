//! Neovim without a screen, with the files of `editor-support/neovim` and the server: from a new file to diagnostics, fixes,
//! renaming and the library. The session is `editor-support/neovim/test/session.lua`.
//!
//! `RPI_NVIM` is the program of Neovim, 0.11 or later.

use std::process::Command;

use rpi_testkit::{report_skip, workspace_root};

/// Returns the program of Neovim: the one that `RPI_NVIM` names, that `.ci/run` installs, or that of the system. `None` if
/// there is none with support for `vim.lsp.enable`.
fn neovim() -> Option<String> {
    let own = workspace_root().join("target/python/bin/nvim");
    let named = std::env::var("RPI_NVIM").ok();
    let candidates = [
        named,
        Some(own.display().to_string()),
        Some("nvim".to_owned()),
    ];
    let is_new = |program: &String| {
        let has_enable = "if !has('nvim-0.11') | cquit | endif";
        let status = Command::new(program)
            .args(["--clean", "--headless", "-c", has_enable, "-c", "quit"])
            .status();
        status.is_ok_and(|status| status.success())
    };
    let found = candidates.into_iter().flatten().find(is_new);
    if found.is_none() {
        report_skip("Neovim 0.11 or later (set RPI_NVIM) is not installed");
    }
    found
}

#[test]
fn a_session_in_neovim() {
    let Some(neovim) = neovim() else { return };
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(neovim)
        .args(["--clean", "--headless", "-u"])
        .arg(workspace_root().join("editor-support/neovim/test/session.lua"))
        .env("RPIC", env!("CARGO_BIN_EXE_rpic"))
        .env("FOLDER", folder.path())
        // The server's copies of the library, and the state of Neovim.
        .envs(["XDG_CACHE_HOME", "XDG_STATE_HOME"].map(|name| (name, folder.path().join(name))))
        .output()
        .unwrap();
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    println!("{text}");
    assert!(output.status.success(), "{text}");
    assert!(text.contains("all 12 steps"), "{text}");
}
