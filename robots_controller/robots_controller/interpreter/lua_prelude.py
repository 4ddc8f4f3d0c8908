"""PRELUDE: the Lua side of the sandbox. It builds the program's globals and runs the program in them."""

from typing import Final

PRELUDE: Final = rb"""
local text, name, serve, next_bytes, ask, count, period, pattern_steps, table_steps, max_arguments,
  patterns_text = ...
local robot_functions = {select(12, ...)}

local error, getmetatable, ipairs, load, next, pairs = error, getmetatable, ipairs, load, next, pairs
local pcall, xpcall, rawget, rawlen, select = pcall, xpcall, rawget, rawlen, select
local setmetatable, tonumber, tostring, type = setmetatable, tonumber, tostring, type
local byte, char, concat, format, rep = string.byte, string.char, table.concat, string.format, string.rep
local gsub, pack, unpack, math_type = string.gsub, table.pack, table.unpack, math.type
local getinfo, sethook, clock = debug.getinfo, debug.sethook, os.clock
local create, resume, status, close = coroutine.create, coroutine.resume, coroutine.status, coroutine.close

-- Stopping -------------------------------------------------------------------------------------------

local STOP = {}
local stopped = false
local last = clock()

local function hook()
  if stopped then error(STOP, 0) end
  local now = clock()
  if now - last >= period or now < last then
    if ask() then
      stopped = true
      error(STOP, 0)
    end
    last = clock()
  end
end

-- What catches errors must hand on the stop: see `caught` and its callers.

-- Lua names the line of a wrapper below; the program does not know it.
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
local last_line = 0

local function program_line()
  local level = 2
  while true do
    local info = getinfo(level, 'Sl')
    if not info then return last_line end
    if info.source == source then
      last_line = info.currentline
      return last_line
    end
    level = level + 1
  end
end

local function program_stack()
  local lines, level = {}, 2
  while #lines < 20 do
    local info = getinfo(level, 'Sln')
    if not info then break end
    if info.source == source then
      local what = info.what == 'main' and 'in the program'
        or info.name and "in function '" .. info.name .. "'"
        or 'in the function of line ' .. info.linedefined
      lines[#lines + 1] = name .. ':' .. info.currentline .. ': ' .. what
    end
    level = level + 1
  end
  return concat(lines, '\n')
end

local function fail(message)
  error(name .. ':' .. program_line() .. ': ' .. message, 0)
end

-- The robot's functions ------------------------------------------------------------------------------

-- Arguments go as pairs of type and value: a table or function itself never leaves Lua.
local function describe_arguments(arguments, n)
  local pairs_ = {}
  for i = 1, n do
    local value = arguments[i]
    local kind = type(value)
    pairs_[2 * i - 1] = kind
    if kind == 'number' or kind == 'string' or kind == 'boolean' then
      pairs_[2 * i] = value
    end
  end
  return pairs_
end

local function call(function_name, arguments, n)
  local line = program_line()
  if n > max_arguments then
    fail(function_name .. ': ' .. n .. ' arguments are too many')
  end
  local described = describe_arguments(arguments, n)
  local outcome, result = serve(function_name, line, unpack(described, 1, 2 * n))
  if outcome == 2 then
    stopped = true
    error(STOP, 0)
  elseif outcome == 1 then
    local parts = {}
    while #parts * 8 < result do
      parts[#parts + 1] = char(next_bytes())
    end
    fail(concat(parts))
  end
  return result
end

local function robot_function(function_name)
  return function(...)
    local n = select('#', ...)
    local first = ...
    if n == 1 and type(first) == 'table' then
      local values, size = {}, rawlen(first)
      for i = 1, size <= max_arguments and size or 0 do values[i] = rawget(first, i) end
      return call(function_name, values, size)
    end
    return call(function_name, {...}, n)
  end
end

local function print_function(...)
  local words = pack(...)
  for i = 1, words.n do words[i] = tostring(words[i]) end
  call('print', {concat(words, '\t')}, 1)
end

-- Bounded library functions --------------------------------------------------------------------------

-- Whether Lua's own matching ends in time: in the worst case it tries all ways to share the characters
-- among the pattern's repetitions.
local function is_quick(s, p, plain, always_search)
  if type(s) ~= 'string' or type(p) ~= 'string' then return true end
  local n, size, i, repeats, steps = #s, #p, 1, 0, 1
  local searches = always_search or plain or byte(p, 1) ~= 94
  while not plain and i <= size do
    local c = byte(p, i)
    if c == 37 then                                                   -- %
      local d = byte(p, i + 1) or 0
      if d == 98 or d >= 48 and d <= 57 then repeats = repeats + 1 end  -- %b, %1
      i = i + (d == 98 and 4 or 2)
    elseif c == 91 then                                               -- a set
      i = i + 1
      if byte(p, i) == 94 then i = i + 1 end
      repeat
        i = i + (byte(p, i) == 37 and 2 or 1)
      until i > size or byte(p, i) == 93
      i = i + 1
    else
      if c == 42 or c == 43 or c == 45 then repeats = repeats + 1 end   -- * + -
      if c == 63 then steps = steps * 2 end                             -- ?
      i = i + 1
    end
    if repeats > 200 or steps > pattern_steps then return false end
  end
  if searches then repeats = repeats + 1 end
  for k = 1, repeats do
    steps = steps * (n + k) / k
    if steps > pattern_steps then return false end
  end
  return steps * size / 32 <= pattern_steps
end

local lib = string
local patterns = load(patterns_text, '=robots', 't')(lib)
local string = {}
for _, key in ipairs {'byte', 'char', 'format', 'len', 'lower', 'pack', 'packsize', 'reverse', 'sub',
                      'unpack', 'upper'} do
  string[key] = lib[key]
end
function string.find(s, p, init, plain)
  if is_quick(s, p, plain) then return lib.find(s, p, init, plain) end
  return patterns.find(s, p, init, plain)
end
function string.match(s, p, init)
  if is_quick(s, p) then return lib.match(s, p, init) end
  return patterns.match(s, p, init)
end
function string.gmatch(s, p, init)
  if is_quick(s, p, false, true) then return lib.gmatch(s, p, init) end
  return patterns.gmatch(s, p, init)
end
function string.gsub(s, p, by, n)
  if is_quick(s, p) then return lib.gsub(s, p, by, n) end
  return patterns.gsub(s, p, by, n)
end
function string.rep(s, n, separator)
  if s == '' and (separator or '') == '' and tonumber(n) then return '' end
  return rep(s, n, separator)
end
local strings = getmetatable('')
strings.__index = string
strings.__metatable = false

local table_lib = table
local table = {pack = table_lib.pack}

local function check_count(what, elements)
  if math_type(elements) and elements > table_steps then
    fail(what .. ': ' .. format('%.0f', elements) .. ' elements; at most ' .. format('%.0f', table_steps))
  end
end

local function check_table(what, t, from, to)
  if type(t) == 'table' then check_count(what, #t) end
  if math_type(to) then check_count(what, to - (math_type(from) and from or 1)) end
end

for _, key in ipairs {'insert', 'remove', 'sort'} do
  local original = table_lib[key]
  table[key] = function(t, ...)
    check_table('table.' .. key, t)
    return original(t, ...)
  end
end
function table.concat(t, separator, from, to)
  check_table('table.concat', t, from, to)
  return table_lib.concat(t, separator, from, to)
end
function table.move(t, from, to, ...)
  check_table('table.move', t, from, to)
  return table_lib.move(t, from, to, ...)
end
function table.unpack(t, from, to)
  check_table('table.unpack', t, from, to)
  return table_lib.unpack(t, from, to)
end

-- Coroutines -----------------------------------------------------------------------------------------

local function hooked(f)
  local co = create(f)
  sethook(co, hook, '', count)
  return co
end

local function unwrap(co, ok, ...)
  if stopped then error(STOP, 0) end
  if ok then return ... end
  hook()
  if status(co) == 'dead' then close(co) end
  error(own_words((...)), 0)
end

local coroutine = {
  create = hooked,
  isyieldable = coroutine.isyieldable,
  running = coroutine.running,
  status = status,
  yield = coroutine.yield,
  resume = function(...) return caught(resume(...)) end,
  close = function(co) return caught(close(co)) end,
  wrap = function(f)
    local co = hooked(f)
    return function(...) return unwrap(co, resume(co, ...)) end
  end,
}

-- The program's globals ------------------------------------------------------------------------------

local function copy(original)
  local new = {}
  for key, value in pairs(original) do new[key] = value end
  return new
end

-- The same program draws the same random numbers in every run.
math.randomseed(1)

local env = {
  _VERSION = _VERSION, assert = assert, error = error, getmetatable = getmetatable, ipairs = ipairs,
  next = next, pairs = pairs, rawequal = rawequal, rawget = rawget, rawlen = rawlen, rawset = rawset,
  select = select, tonumber = tonumber, tostring = tostring, type = type,
  coroutine = coroutine, math = copy(math), string = string, table = table, utf8 = copy(utf8),
  pcall = function(...) return caught(pcall(...)) end,
  xpcall = function(f, handler, ...)
    if type(handler) ~= 'function' then
      fail("bad argument #2 to 'xpcall' (function expected, got " .. type(handler) .. ')')
    end
    -- A handler called for the stop would run without hooks.
    local function handle(problem)
      if stopped then return problem end
      return handler(own_words(problem))
    end
    return caught(xpcall(f, handle, ...))
  end,
  setmetatable = function(t, meta)
    if type(meta) == 'table' and rawget(meta, '__gc') ~= nil then
      fail('setmetatable: finalizers (__gc) are not available in robot programs')
    end
    return setmetatable(t, meta)
  end,
}
env._G = env
for _, key in ipairs(robot_functions) do
  env[key] = key == 'print' and print_function or robot_function(key)
end

-- The run --------------------------------------------------------------------------------------------

local function describe(problem)
  if stopped then return STOP end
  local kind, message = type(problem), nil
  if kind == 'string' then
    message = own_words(problem)
  elseif kind == 'number' or (getmetatable(problem) or {}).__tostring then
    message = tostring(problem)
  else
    message = 'error with a ' .. kind .. ' value instead of a message'
  end
  return {line = program_line(), reason = message, stack = program_stack()}
end

return function()
  local program, problem = load(text, source, 't', env)
  if not program then return false, 0, problem, '' end
  sethook(hook, '', count)
  local ok, failure = xpcall(program, describe)
  sethook()
  if stopped then return true, 0, '', '' end
  if ok then return nil end
  if type(failure) == 'table' then return false, failure.line, failure.reason, failure.stack end
  return false, 0, tostring(failure), ''
end
"""
