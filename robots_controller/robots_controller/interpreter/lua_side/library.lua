-- The program's globals, bounded in time.

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
local patterns = load(patterns_code, '=robots', 'b')(lib)
local string = {}
for _, key in ipairs {'byte', 'char', 'len', 'lower', 'pack', 'packsize', 'reverse', 'sub', 'unpack',
                      'upper'} do
  string[key] = lib[key]
end
string.format = format_text
for _, key in ipairs {'find', 'match', 'gmatch', 'gsub'} do
  string[key] = function(s, p, ...)
    local plain = key == 'find' and select(2, ...)
    local matching = is_quick(s, p, plain, key == 'gmatch') and lib or patterns
    return matching[key](s, p, ...)
  end
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

-- Lua would ask __len a second time, which may answer with another length then.
local function check_length(what, t)
  if type(t) ~= 'table' then return end
  local meta = raw_metatable(t)
  if meta and rawget(meta, '__len') ~= nil then fail(what .. ': a table whose length is __len') end
  check_count(what, rawlen(t))
end

-- The bounds that are given, or those of the whole table.
local function bounds(what, t, from, to)
  from = from == nil and 1 or from
  if to == nil and type(t) == 'table' then to = #t end
  if math_type(from) and math_type(to) then check_count(what, to + 0.0 - from) end
  return from, to
end

for _, key in ipairs {'insert', 'remove', 'sort'} do
  local original = table_lib[key]
  table[key] = function(t, ...)
    check_length('table.' .. key, t)
    return original(t, ...)
  end
end
function table.concat(t, separator, from, to)
  return table_lib.concat(t, separator, bounds('table.concat', t, from, to))
end
function table.move(t, from, to, ...)
  bounds('table.move', t, from, to)
  return table_lib.move(t, from, to, ...)
end
function table.unpack(t, from, to)
  return table_lib.unpack(t, bounds('table.unpack', t, from, to))
end

-- Coroutines -----------------------------------------------------------------------------------------

local function hooked(f)
  local co = create(f)
  traced[co] = tracing
  sethook(co, hook, tracing and 'l' or '', count)
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

-- The same program goes through its tables in the same order in every run, too: Lua's own order of strings
-- is another one in every process. Numbers come first, then strings, both sorted, then what has no order.
local RANKS = {number = 1, string = 2, boolean = 3}
local function before(a, b)
  local rank, other = RANKS[type(a)], RANKS[type(b)]
  if rank ~= other then return rank < other end
  if rank == 3 then return b and not a end
  return a < b
end
local function in_order(t)
  local meta = type(t) == 'table' and getmetatable(t)
  if type(t) ~= 'table' or (type(meta) == 'table' and meta.__pairs ~= nil) then return pairs(t) end
  local any
  for key in next, t do
    if type(key) == 'string' then any = true break end
  end
  if not any then return next, t, nil end
  local keys, others, n, m = {}, {}, 0, 0
  for key in next, t do
    if RANKS[type(key)] then n = n + 1 keys[n] = key else m = m + 1 others[m] = key end
  end
  table_lib.sort(keys, before)
  for i = 1, m do keys[n + i] = others[i] end
  local i = 0
  return function()
    while true do
      i = i + 1
      local key = keys[i]
      if key == nil then return nil end
      local value = rawget(t, key)
      if value ~= nil then return key, value end -- else the loop has removed it
    end
  end, t, nil
end

-- The same program draws the same random numbers in every run; Lua's own seed would be clock and address.
local SEED = 1
local numeric = copy(math)
function numeric.randomseed(...)
  if select('#', ...) == 0 then return math.randomseed(SEED) end
  return math.randomseed(...)
end
math.randomseed(SEED)

env = {
  _VERSION = _VERSION, assert = assert, error = error, getmetatable = getmetatable, ipairs = ipairs,
  next = next, pairs = in_order, rawequal = rawequal, rawget = rawget, rawlen = rawlen, rawset = rawset,
  select = select, tonumber = tonumber, tostring = text_of, type = type,
  coroutine = coroutine, math = numeric, string = string, table = table, utf8 = copy(utf8),
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
  env[key] = special[key] or robot_function(key)
  motion_names[env[key]] = key
end
for key in pairs(env) do builtin[key] = true end

