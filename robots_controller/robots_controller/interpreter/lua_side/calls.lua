-- Calls of robot functions, and what is served meanwhile: interrupts, tasks, holds.

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

-- Poses: tables of six numbers with operators, see own_functions.lua.
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

