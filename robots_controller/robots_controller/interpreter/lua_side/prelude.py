"""PRELUDE: the Lua side of the sandbox. It builds the program's globals and runs the program in them.

One Lua chunk: what a part declares, the parts behind it use.
"""

from typing import Final

from robots_controller.interpreter.lua_side.library import LIBRARY
from robots_controller.interpreter.lua_side.own_functions import OWN_FUNCTIONS
from robots_controller.interpreter.lua_side.snapshot import SNAPSHOT
from robots_controller.interpreter.lua_side.texts import TEXTS

_STOPPING: Final = rb"""
local text, name, host, count, period, spell, pattern_steps, table_steps, max_arguments, patterns_text = ...
local robot_functions = {select(11, ...)}
local serve, again, abandon, next_values, ask, computed, at_line, attention, held, handled = host()

local error, getmetatable, ipairs, load, next, pairs = error, getmetatable, ipairs, load, next, pairs
local pcall, xpcall, rawget, rawlen, rawset, select = pcall, xpcall, rawget, rawlen, rawset, select
local setmetatable, tonumber, tostring, type = setmetatable, tonumber, tostring, type
local byte, char, concat, format, rep = string.byte, string.char, table.concat, string.format, string.rep
local gmatch, gsub, pack, unpack = string.gmatch, string.gsub, table.pack, table.unpack
local floor, math_type = math.floor, math.type
local getinfo, sethook, clock = debug.getinfo, debug.sethook, os.clock
local getlocal, getupvalue, raw_metatable = debug.getlocal, debug.getupvalue, debug.getmetatable
local string_pack, sub = string.pack, string.sub
local running = coroutine.running
local create, resume, status, close = coroutine.create, coroutine.resume, coroutine.status, coroutine.close
local yield = coroutine.yield

-- Stopping, holding, interrupts -----------------------------------------------------------------------

local STOP = {}
local stopped = false
local last = clock()
local STOP_BIT, ATTEND_BIT, TRACE_BIT, DEPTH_BIT = 1, 2, 4, 8
local tracing, wants_depth = false, false
local traced = setmetatable({}, {__mode = 'k'})
local attend, sources, hook, program_place
local instructions = 0
local MAX_TASK_INSTRUCTIONS, current_task, task_instructions = 1000000, nil, 0

-- Lines are reported during debugging alone: each costs a call of Python.
local function trace(code)
  tracing, wants_depth = code & TRACE_BIT ~= 0, code & DEPTH_BIT ~= 0
  local co = running()
  if tracing ~= (traced[co] or false) then
    traced[co] = tracing
    sethook(hook, tracing and 'l' or '', count)
  end
end

local function obey(code)
  if code & STOP_BIT ~= 0 then
    stopped = true
    error(STOP, 0)
  end
  if current_task then return end       -- the main program attends, when the task waits
  trace(code)
  if code & ATTEND_BIT ~= 0 then
    local ok, failed, problem = pcall(attend, true)
    current_task = nil
    if stopped then error(STOP, 0) end
    if not ok then held() end           -- no room on the stack to look around: hold all the same
    if ok and failed then error(problem, 0) end
  end
end

-- Levels below the innermost of the program. Finding one takes Lua as long as it is deep: few looks.
local function depth()
  local first = 2
  while true do
    local info = getinfo(first, 'S')
    if not info then return 0 end
    if sources[info.source] then break end
    first = first + 1
  end
  local low, high = first, 2 * first
  while getinfo(high, 'l') do low, high = high, 2 * high end
  while high - low > 1 do
    local middle = (low + high) // 2
    if getinfo(middle, 'l') then low = middle else high = middle end
  end
  return low - first + 1
end

local last_reported, counted = 0, false

function hook(event, line)
  if stopped then error(STOP, 0) end
  if event == 'line' then
    -- A hook in the middle of a line makes Lua report that line a second time.
    local reported = counted and line == last_reported
    last_reported, counted = line, false
    local chunk = not reported and sources[getinfo(2, 'S').source]
    if chunk then obey(at_line(chunk, line, wants_depth and depth() or 0)) end
    -- Instructions of the hook count too: a loop in step with them would never see a count of its own.
  elseif event == 'count' then
    counted = true
    if current_task then
      task_instructions = task_instructions + count
      if task_instructions > MAX_TASK_INSTRUCTIONS then
        local chunk, at = program_place()
        error(chunk .. ':' .. at .. ': a task computes without end; it must wait now and then', 0)
      end
      return
    end
    instructions = instructions + count
    if instructions >= spell then
      instructions = 0
      obey(computed(program_place()))
    end
  end
  local now = clock()
  if now - last >= period or now < last then
    obey(ask())
    last = clock()
  end
end

-- What catches errors must hand on the stop: see `caught` and its callers.

-- Lua names the line of a wrapper below, which is no line of the program.
local function own_words(problem)
  if type(problem) == 'string' then return (gsub(problem, '^robots:%d+: ', '')) end
  return problem
end

local function caught(ok, ...)
  if stopped then error(STOP, 0) end
  if ok then return ok, ... end
  -- Where the stack is full the hook fails as any call does; here is room for it again.
  hook()
  return ok, own_words((...)), select(2, ...)
end

-- Where the program is -------------------------------------------------------------------------------

local source = '=' .. name
local last_chunk, last_line = name, 0
sources = {[source] = name}

function program_place()
  local level = 2
  while true do
    local info = getinfo(level, 'Sl')
    if not info then return last_chunk, last_line end
    if sources[info.source] then
      last_chunk, last_line = sources[info.source], info.currentline
      return last_chunk, last_line
    end
    level = level + 1
  end
end

local MAX_NAME = 100

local function frame_name(info)
  return info.what == 'main' and 'in the program'
    or info.name and "in function '" .. sub(info.name, 1, MAX_NAME) .. "'"
    or 'in the function of line ' .. info.linedefined
end

local function program_stack()
  local lines, level = {}, 2
  while #lines < 20 do
    local info = getinfo(level, 'Sln')
    if not info then break end
    if sources[info.source] then
      lines[#lines + 1] = sources[info.source] .. ':' .. info.currentline .. ': ' .. frame_name(info)
    end
    level = level + 1
  end
  return concat(lines, '\n')
end

local function fail(message)
  local chunk, line = program_place()
  error(chunk .. ':' .. line .. ': ' .. message, 0)
end

"""

_CALLS: Final = rb"""
-- A string as long as the memory allows would keep Python, and with it every service, busy for a second.
local MAX_ITEMS, MAX_NESTING, MAX_STRING = 2000, 4, 10000

local function check_string(what, text)
  if #text > MAX_STRING then
    fail(what .. ': a string of ' .. #text .. ' bytes; valid are at most ' .. MAX_STRING)
  end
end

-- Arguments go as pairs of type and value, a table as its counts and entries: no table leaves Lua.
local function describe_argument(what, items, value, nesting)
  local kind = type(value)
  local n = #items
  if n > MAX_ITEMS then fail(what .. ': a table has too many entries') end
  items[n + 1] = kind
  if kind ~= 'table' then
    if kind == 'string' then check_string(what, value) end
    if kind == 'number' or kind == 'string' or kind == 'boolean' then
      items[n + 2] = value
    else
      items[n + 2] = false
    end
    return
  end
  if nesting > MAX_NESTING then fail(what .. ': a table is nested too deeply') end
  local size = rawlen(value)
  if size > MAX_ITEMS then fail(what .. ': a table has too many entries') end
  items[n + 2] = size
  for i = 1, size do describe_argument(what, items, rawget(value, i), nesting + 1) end
  local place, fields = #items + 1, 0
  items[place] = 0
  for key, entry in next, value do
    if not (math_type(key) == 'integer' and key >= 1 and key <= size) then
      if type(key) ~= 'string' then
        fail(what .. ': a table has a ' .. type(key) .. ' as key; lists have no gaps')
      end
      check_string(what, key)
      items[#items + 1] = key
      describe_argument(what, items, entry, nesting + 1)
      fields = fields + 1
    end
  end
  items[place] = fields
end

local handlers = {}

local function run_handler(id, in_hook)
  local handler, ok, verdict = handlers[id], nil, nil
  if in_hook then                       -- the hook itself runs without hooks: a coroutine has its own
    local co = create(handler.run)
    sethook(co, hook, tracing and 'l' or '', count)
    ok, verdict = resume(co)
    if ok and status(co) == 'suspended' then ok, verdict = false, 'the handler of an input cannot yield' end
  else
    ok, verdict = pcall(handler.run)
  end
  if stopped then error(STOP, 0) end
  local chunk, line = program_place()
  if ok and verdict ~= nil and verdict ~= 'abort' then
    ok = false
    verdict = chunk .. ':' .. line .. ': ' .. handler.function_name .. ': the handler returned a '
      .. type(verdict) .. "; valid are nothing and 'abort'"
  end
  local problem = handled(not ok or verdict == 'abort')
  if problem == 1 then
    stopped = true
    error(STOP, 0)
  end
  return not ok, verdict
end

local tasks = {}
local task_news = 0                     -- for `attention`: which task begins, or minus which one has ended

-- Lets a task go on until it waits; returns what is wrong if it failed.
local function run_task(id)
  local co = tasks[id]
  current_task, task_instructions = co, 0
  local _, failure = resume(co)
  current_task = true
  if stopped then error(STOP, 0) end
  if status(co) ~= 'dead' then return nil end
  tasks[id], task_news = nil, -id
  return failure
end

-- Serves what came up: returns true and a problem where a handler or a task failed.
function attend(in_hook)
  while true do
    current_task = true                 -- no hook attends before the task that goes on has done so
    local kind, id = attention(task_news)
    task_news = 0
    if kind ~= 4 then current_task = nil end
    if kind == 0 then return false end
    if kind == 1 then
      stopped = true
      error(STOP, 0)
    elseif kind == 2 then
      local failed, problem = run_handler(id, in_hook)
      if failed then return true, problem end
    elseif kind == 4 then
      local failure = run_task(id)
      if failure then
        current_task = nil
        return true, failure
      end
    else
      local records = snapshot()
      local code = held(unpack(records, 1, #records))
      if code & STOP_BIT ~= 0 then
        stopped = true
        error(STOP, 0)
      end
      trace(code)
    end
  end
end

local function received(n)
  local parts, got = {}, 0
  while got < n do
    local step = pack(next_values())
    for i = 1, step.n do
      got = got + 1
      parts[got] = step[i]
    end
  end
  return parts
end

local function received_text(bytes)
  local parts = received((bytes + 7) // 8)
  for i = 1, #parts do parts[i] = string_pack('<i8', parts[i]) end
  return sub(concat(parts), 1, bytes)
end

-- Poses: tables of six numbers with operators, see OWN_FUNCTIONS.
local POSE = {}

local function received_lists(n)
  local values, lists, i = received(n), {}, 1
  while i <= n do
    local list, size = {}, values[i]
    if size < 0 then
      setmetatable(list, POSE)
      size = -size
    end
    for k = 1, size do list[k] = values[i + k] end
    lists[#lists + 1] = list
    i = i + 1 + size
  end
  return unpack(lists)
end

-- Attends at a call; `token` is that of the call that fails with what comes up.
local function attend_now(token)
  local ok, failed, problem = pcall(attend, false)
  current_task = nil
  if not ok or failed then
    if token then abandon(token) end
    if stopped then error(STOP, 0) end
    error(ok and problem or failed, 0)
  end
end

local function call(function_name, arguments, n)
  local chunk, line = program_place()
  if n > max_arguments then
    fail(function_name .. ': ' .. n .. ' arguments are too many')
  end
  local items = {}
  for i = 1, n do describe_argument(function_name, items, arguments[i], 1) end
  local outcome, result, token = serve(function_name, chunk, line, unpack(items, 1, #items))
  while outcome == 4 do
    if current_task then
      if running() ~= current_task then
        abandon(token)
        fail(function_name .. ': a coroutine of a task cannot wait')
      end
      yield()
    else
      attend_now(token)
    end
    outcome, result, token = again(token)
  end
  if outcome == 2 then
    stopped = true
    error(STOP, 0)
  elseif outcome == 1 then
    fail(received_text(result))
  elseif outcome == 3 then
    return received_lists(result)
  elseif outcome == 5 then
    return received_text(result)
  elseif outcome == 6 then
    return nil
  end
  return result
end

local function robot_function(function_name)
  return function(...) return call(function_name, {...}, select('#', ...)) end
end

"""

_RUN: Final = rb"""
local MAX_MESSAGE = 1000

function describe(problem)
  if stopped then return STOP end
  if getmetatable(problem) == FAILURE then return problem end
  local kind, message = type(problem), nil
  if kind == 'string' then
    message = own_words(problem)
  elseif kind == 'number' or (getmetatable(problem) or {}).__tostring then
    message = tostring(problem)
  else
    message = 'error with a ' .. kind .. ' value instead of a message'
  end
  -- A message as long as the memory allows would take its reader seconds.
  if #message > MAX_MESSAGE then message = sub(message, 1, MAX_MESSAGE) .. '...' end
  local chunk, line = program_place()
  return setmetatable({chunk = chunk, line = line, reason = message, stack = program_stack()}, FAILURE)
end

return function()
  local program, problem = load(text, source, 't', env)
  if not program then return false, name, 0, problem, '' end
  local ok, failure = xpcall(function()
    sethook(hook, '', count)
    trace(ask())                        -- the first line reports what is due at the start
    program()
    call('', {}, 0)                     -- the program ends when the robot stands
  end, describe)
  sethook()
  if stopped then return true, name, 0, '', '' end
  if ok then return nil end
  if type(failure) == 'table' then
    return false, failure.chunk, failure.line, failure.reason, failure.stack
  end
  return false, name, 0, tostring(failure), ''
end
"""

PRELUDE: Final = _STOPPING + SNAPSHOT + TEXTS + _CALLS + OWN_FUNCTIONS + LIBRARY + _RUN
