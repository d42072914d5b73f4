-- A session of a new user in Neovim without a screen, run by the test `neovim` of rpic:
--   nvim --clean --headless -u editor-support/neovim/test/session.lua
-- with the environment variables RPIC (the compiler) and FOLDER (an empty folder for the program). It prints one line for each
-- step, and ends with an error at the first one that fails.

local here = vim.fn.fnamemodify(debug.getinfo(1, "S").source:sub(2), ":p:h:h")
local file = vim.env.FOLDER .. "/first.rpi"
local PATIENCE = 30000

-- What README.md of editor-support tells users to write into init.lua.
vim.opt.runtimepath:prepend(here)
vim.lsp.config("rpi", { cmd = { vim.env.RPIC, "lsp" } })
vim.lsp.enable("rpi")
vim.cmd("filetype plugin on | syntax on")

local TEXT = [[
use motion;

command Climb (arm: Arm; to: Pose)
let
  way = Line(arm, to, speed: 100[mm/s]);
  arm.tcp = way.pose;
  finish done when way.done;
  fail   stopped when way.stopped;
tel
]]

local function wait(what, condition)
  local value
  local reached = vim.wait(PATIENCE, function()
    value = condition()
    return value
  end, 20)
  assert(reached, "no " .. what .. " after " .. PATIENCE .. " ms")
  return value
end

--- Puts the cursor on the first place of a text, and `offset` bytes further.
local function go_to(text, offset)
  for number, line in ipairs(vim.api.nvim_buf_get_lines(0, 0, -1, true)) do
    local column = line:find(text, 1, true)
    if column then
      vim.api.nvim_win_set_cursor(0, { number, column - 1 + (offset or 0) })
      return
    end
  end
  error("no " .. text .. " in the buffer")
end

local function request(method, extra)
  local client = vim.lsp.get_clients({ bufnr = 0, name = "rpi" })[1]
  local params = vim.tbl_extend("force", vim.lsp.util.make_position_params(0, client.offset_encoding), extra or {})
  -- With the number of the buffer, Neovim sends pending changes before.
  local answer = assert(client:request_sync(method, params, PATIENCE, vim.api.nvim_get_current_buf()))
  assert(not answer.err, vim.inspect(answer.err))
  return answer.result, client
end

local function buffer_text()
  return table.concat(vim.api.nvim_buf_get_lines(0, 0, -1, true), "\n")
end

local steps = {
  { "the type of the file and its options", function()
    assert(vim.bo.filetype == "rpi", vim.bo.filetype)
    assert(vim.bo.shiftwidth == 2 and vim.bo.expandtab and vim.bo.commentstring == "-- %s")
  end },
  { "highlighted words", function()
    go_to("finish")
    local position = vim.api.nvim_win_get_cursor(0)
    local group = vim.fn.synIDattr(vim.fn.synID(position[1], position[2] + 1, 1), "name")
    assert(group ~= "", "`finish` has no highlighting")
  end },
  { "the server starts", function()
    wait("client", function() return vim.lsp.get_clients({ bufnr = 0, name = "rpi" })[1] end)
    local hover = wait("hover", function()
      go_to("Line(")
      return request("textDocument/hover")
    end)
    local text = type(hover.contents) == "table" and hover.contents.value or hover.contents
    assert(text:find("fragment Line", 1, true), vim.inspect(text))
  end },
  { "no diagnostic for a right program", function()
    assert(#vim.diagnostic.get(0) == 0, vim.inspect(vim.diagnostic.get(0)))
  end },
  { "an error is shown before the file is saved", function()
    go_to("way.done")
    vim.cmd("normal! 2wcwdoen")
    local found = wait("diagnostic", function() return vim.diagnostic.get(0)[1] end)
    assert(found.lnum == 6 and found.source == "rpic" and found.code, vim.inspect(found))
    assert(vim.bo.modified)
  end },
  { "a fix mends it", function()
    go_to("doen")
    local found = vim.diagnostic.get(0)[1]
    local actions, client = request("textDocument/codeAction", {
      range = found.user_data.lsp.range,
      context = { diagnostics = { found.user_data.lsp } },
    })
    local fix = vim.iter(actions):find(function(action) return action.kind == "quickfix" end)
    assert(fix, vim.inspect(actions))
    if not fix.edit then
      fix = request("codeAction/resolve", fix)
    end
    vim.lsp.util.apply_workspace_edit(fix.edit, client.offset_encoding)
    assert(buffer_text():find("way.done", 1, true), buffer_text())
    wait("end of the diagnostic", function() return #vim.diagnostic.get(0) == 0 end)
  end },
  { "completion after a dot", function()
    go_to("way.pose", 4)
    local result = request("textDocument/completion")
    local items = result.items or result
    local names = vim.iter(items):map(function(item) return item.label end):totable()
    assert(vim.tbl_contains(names, "progress") and not vim.tbl_contains(names, "let"), vim.inspect(names))
  end },
  { "a name is renamed", function()
    go_to("way")
    vim.lsp.buf.rename("path")
    wait("new name", function() return buffer_text():find("finish done when path.done", 1, true) end)
    assert(not buffer_text():find("way", 1, true), buffer_text())
  end },
  { "references", function()
    go_to("path")
    local places = request("textDocument/references", { context = { includeDeclaration = true } })
    assert(#places == 4, vim.inspect(places))
  end },
  { "code lenses", function()
    local lenses = request("textDocument/codeLens")
    assert(vim.iter(lenses):any(function(lens) return lens.command and vim.lsp.commands[lens.command.command] end), vim.inspect(lenses))
  end },
  { "formatting", function()
    local before = buffer_text()
    go_to("  arm.tcp")
    vim.cmd("normal! I      ")
    vim.lsp.buf.format({ timeout_ms = PATIENCE })
    assert(buffer_text() == before, buffer_text())
  end },
  { "the declaration in the library, which cannot be changed", function()
    go_to("Line(")
    vim.lsp.buf.definition()
    wait("library", function() return vim.api.nvim_buf_get_name(0):find("motion", 1, true) end)
    assert(vim.api.nvim_get_current_line():find("fragment Line", 1, true), vim.api.nvim_get_current_line())
    local name = vim.api.nvim_buf_get_name(0)
    assert(vim.bo.readonly or vim.fn.filewritable(name) == 0, name .. " can be written")
  end },
}

local function run()
  local out = assert(io.open(file, "w"))
  out:write(TEXT)
  out:close()
  vim.cmd.edit(file)
  for _, step in ipairs(steps) do
    local name, action = unpack(step)
    local passed, why = xpcall(action, debug.traceback)
    if not passed then
      io.stdout:write("FAILED ", name, ": ", tostring(why), "\n")
      vim.cmd("cquit 1")
    end
    io.stdout:write("passed ", name, "\n")
  end
  io.stdout:write("all ", #steps, " steps\n")
  vim.cmd("qall!")
end

vim.api.nvim_create_autocmd("VimEnter", { callback = vim.schedule_wrap(run) })
