-- The sandbox, first part: what stops and holds the program, and where the program is.

local text, name, host, count, period, spell, pattern_steps, table_steps, max_arguments, patterns_code = ...
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
local tracing, needs_depth = false, false
local traced = setmetatable({}, {__mode = 'k'})
local attend, sources, hook, program_place
local instructions = 0
local MAX_TASK_INSTRUCTIONS, current_task, task_instructions = 1000000, nil, 0

-- Lines are reported during debugging alone: each costs a call of Python.
local function trace(code)
  tracing, needs_depth = code & TRACE_BIT ~= 0, code & DEPTH_BIT ~= 0
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
    if not ok then held() end           -- no room on the stack to look around: hold anyway
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
    if chunk then obey(at_line(chunk, line, needs_depth and depth() or 0)) end
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

