-- The same as for .rpi.
vim.cmd.runtime("ftplugin/rpi.lua")
