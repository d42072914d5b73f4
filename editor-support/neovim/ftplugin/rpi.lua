-- How programs are written: comments, and the indentation of `rpic fmt`.
vim.bo.commentstring = "-- %s"
vim.bo.comments = ":--|,:--"
vim.bo.expandtab = true
vim.bo.shiftwidth = 2
vim.bo.softtabstop = 2

if vim.fn.has("nvim-0.9") == 0 and not vim.g.rpi_version_reported then
  vim.g.rpi_version_reported = true
  vim.notify("RPI: the language server needs Neovim 0.9 or later; only the syntax is highlighted", vim.log.levels.WARN)
end
