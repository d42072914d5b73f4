-- The language server. `vim.lsp.enable("rpi")` switches it on; `vim.lsp.config("rpi", { ... })` changes what is here.
return {
  cmd = { "rpic", "lsp" },
  filetypes = { "rpi", "lustre" },
  root_markers = { "rpi.toml", "cell.toml", ".git" },
}
