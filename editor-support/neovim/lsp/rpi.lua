-- The language server. `vim.lsp.enable("rpi")` switches it on; `vim.lsp.config("rpi", { ... })` changes what is here.

--- Opens a terminal that runs a program with arguments.
local function in_terminal(...)
  vim.cmd.new()
  vim.fn.termopen({ ... })
end

-- Commands of the code lenses (`vim.lsp.codelens.run()`). The server runs no programs itself.
vim.lsp.commands["rpi.run"] = function(command)
  in_terminal("rpi", "run", command.arguments[1], "--command", command.arguments[2])
end
vim.lsp.commands["rpi.runTest"] = function(command)
  in_terminal("rpic", "test", command.arguments[1], "--filter", command.arguments[2])
end
vim.lsp.commands["rpi.showNet"] = function(command)
  in_terminal("rpic", "graph", command.arguments[1], "--command", command.arguments[2])
end
vim.lsp.commands["rpi.showReferences"] = function(command)
  local items = vim.lsp.util.locations_to_items(command.arguments[3], "utf-16")
  vim.fn.setqflist({}, " ", { title = "References", items = items })
  vim.cmd.copen()
end

return {
  cmd = { "rpic", "lsp" },
  filetypes = { "rpi", "lustre" },
  root_markers = { "rpi.toml", "cell.toml", ".git" },
}
