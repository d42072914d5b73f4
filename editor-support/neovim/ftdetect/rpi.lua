-- Which files are programs. Lustre shares the tools, but not all of the words.
vim.filetype.add({ extension = { rpi = "rpi", lus = "lustre" } })
