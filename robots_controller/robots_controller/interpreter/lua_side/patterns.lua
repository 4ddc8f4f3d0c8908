-- Lua's pattern matching, written in Lua.
-- Lua's own matches in C, where no hook stops it: a pattern with several repetitions may take years. The
-- sandbox uses these functions, which can be stopped anywhere, where the own ones might not end in time.
-- Semantics: Lua 5.4 reference manual, section 6.4.1.

local lib = ...
local error, tonumber, type = error, tonumber, type
local byte, char, sub, find = lib.byte, lib.char, lib.sub, lib.find
local concat, unpack, to_integer = table.concat, table.unpack, math.tointeger

local MAX_CAPTURES = 32
local UNFINISHED, POSITION = -1, -2
local PERCENT, ANCHOR = 37, 94
local QUANTIFIERS = {[42] = '*', [43] = '+', [45] = '-', [63] = '?'}

local function class_end(p, i)
  local c, size = byte(p, i), #p
  if c == PERCENT then
    if i == size then error("malformed pattern (ends with '%')", 0) end
    return i + 2
  elseif c ~= 91 then
    return i + 1
  end
  i = i + 1
  if byte(p, i) == ANCHOR then i = i + 1 end
  repeat                              -- a ']' that comes first stands for itself
    if i > size then error("malformed pattern (missing ']')", 0) end
    i = i + (byte(p, i) == PERCENT and 2 or 1)
  until byte(p, i) == 93
  return i + 1
end

-- Which bytes a class without repetition matches: Lua's own matcher finds them in no time.
local function class_set(p, i, stop)
  local c, set = byte(p, i), {}
  if c ~= PERCENT and c ~= 91 and c ~= 46 then
    set[c] = true
    return set
  end
  local class = sub(p, i, stop - 1)
  for code = 0, 255 do
    set[code] = find(char(code), class) ~= nil
  end
  return set
end

local function compile(p, i)
  local items, size = {}, #p
  while i <= size do
    local c, d = byte(p, i), byte(p, i + 1)
    local item
    if c == 40 and d == 41 then
      item, i = {kind = 'open', len = POSITION}, i + 2
    elseif c == 40 then
      item, i = {kind = 'open', len = UNFINISHED}, i + 1
    elseif c == 41 then
      item, i = {kind = 'close'}, i + 1
    elseif c == 36 and i == size then
      item, i = {kind = 'end'}, i + 1
    elseif c == PERCENT and d == 98 then
      if i + 3 > size then error("malformed pattern (missing arguments to '%b')", 0) end
      item, i = {kind = 'balance', first = byte(p, i + 2), last = byte(p, i + 3)}, i + 4
    elseif c == PERCENT and d == 102 then
      if byte(p, i + 2) ~= 91 then error("missing '[' after '%f' in pattern", 0) end
      local stop = class_end(p, i + 2)
      item, i = {kind = 'frontier', set = class_set(p, i + 2, stop)}, stop
    elseif c == PERCENT and d and d >= 48 and d <= 57 then
      item, i = {kind = 'back', capture = d - 48}, i + 2
    else
      local stop = class_end(p, i)
      local quantifier = QUANTIFIERS[byte(p, stop)]
      item = {kind = 'single', set = class_set(p, i, stop), quantifier = quantifier}
      i = quantifier and stop + 1 or stop
    end
    items[#items + 1] = item
  end
  return items
end

-- A matcher of one pattern on one string: match(i) gives the position after the match that begins at i.
local function matcher(s, items)
  local size, n, starts, lens = #s, 0, {}, {}
  local match_from

  local function open(item, k, i)
    n = n + 1
    if n > MAX_CAPTURES then error('too many captures', 0) end
    starts[n], lens[n] = i, item.len
    local stop = match_from(k + 1, i)
    if not stop then n = n - 1 end
    return stop
  end

  local function close(k, i)
    local l = n
    while l > 0 and lens[l] ~= UNFINISHED do l = l - 1 end
    if l == 0 then error('invalid pattern capture', 0) end
    lens[l] = i - starts[l]
    local stop = match_from(k + 1, i)
    if not stop then lens[l] = UNFINISHED end
    return stop
  end

  local function balance(item, i)
    if i > size or byte(s, i) ~= item.first then return nil end
    local depth = 1
    for j = i + 1, size do
      local c = byte(s, j)
      if c == item.last then
        depth = depth - 1
        if depth == 0 then return j + 1 end
      elseif c == item.first then
        depth = depth + 1
      end
    end
    return nil
  end

  local function back(item, i)
    local l = item.capture
    if l == 0 or l > n or lens[l] == UNFINISHED then
      error('invalid capture index %' .. l .. ' in pattern', 0)
    end
    local len = lens[l]
    if len == POSITION or sub(s, i, i + len - 1) ~= sub(s, starts[l], starts[l] + len - 1) then return nil end
    return i + len
  end

  local function longest(item, k, i)
    local set, j = item.set, i
    while j <= size and set[byte(s, j)] do j = j + 1 end
    for stop = j, item.quantifier == '+' and i + 1 or i, -1 do
      local found = match_from(k + 1, stop)
      if found then return found end
    end
    return nil
  end

  local function shortest(item, k, i)
    while true do
      local found = match_from(k + 1, i)
      if found then return found end
      if i > size or not item.set[byte(s, i)] then return nil end
      i = i + 1
    end
  end

  function match_from(k, i)
    while true do
      local item = items[k]
      if not item then return i end
      local kind, quantifier = item.kind, item.quantifier
      if quantifier == '*' or quantifier == '+' then return longest(item, k, i) end
      if quantifier == '-' then return shortest(item, k, i) end
      if kind == 'open' then return open(item, k, i) end
      if kind == 'close' then return close(k, i) end
      if kind == 'single' then
        local fits = i <= size and item.set[byte(s, i)]
        if quantifier then
          local found = fits and match_from(k + 1, i + 1)
          if found then return found end
        elseif fits then
          i = i + 1
        else
          return nil
        end
      elseif kind == 'end' then
        if i ~= size + 1 then return nil end
      elseif kind == 'frontier' then
        if item.set[byte(s, i - 1) or 0] or not item.set[byte(s, i) or 0] then return nil end
      elseif kind == 'balance' then
        i = balance(item, i)
      else
        i = back(item, i)
      end
      if not i then return nil end
      k = k + 1
    end
  end

  local self = {}

  function self.match(i)
    n = 0
    return match_from(1, i)
  end

  function self.whole(from, stop)
    return sub(s, from, stop - 1)
  end

  function self.capture(l, from, stop)
    if l > n then
      if l > 1 then error('invalid capture index %' .. l, 0) end
      return self.whole(from, stop)
    end
    local len = lens[l]
    if len == UNFINISHED then error('unfinished capture', 0) end
    if len == POSITION then return starts[l] end
    return sub(s, starts[l], starts[l] + len - 1)
  end

  -- All captures; of a pattern without any, the whole match if wanted.
  function self.captures(from, stop, whole)
    local values, count = {}, n == 0 and whole and 1 or n
    for l = 1, count do values[l] = self.capture(l, from, stop) end
    return unpack(values, 1, count)
  end

  return self
end

local function start_position(s, init)
  find('', '', init)                            -- raises what is no position
  init = to_integer(tonumber(init or 1))
  if init < 0 then init = #s + init + 1 end
  return init < 1 and 1 or init
end

local function find_plain(s, p, i)
  for j = i, #s - #p + 1 do
    if sub(s, j, j + #p - 1) == p then return j, j + #p - 1 end
  end
  return nil
end

local function search(s, p, init, finding)
  local i = start_position(s, init)
  if i > #s + 1 then return nil end
  local anchored = byte(p, 1) == ANCHOR
  local m = matcher(s, compile(p, anchored and 2 or 1))
  repeat
    local stop = m.match(i)
    if stop and finding then return i, stop - 1, m.captures(i, stop, false) end
    if stop then return m.captures(i, stop, true) end
    i = i + 1
  until anchored or i > #s + 1
  return nil
end

local patterns = {}

function patterns.find(s, p, init, plain)
  if plain then return find_plain(s, p, start_position(s, init)) end
  return search(s, p, init, true)
end

function patterns.match(s, p, init)
  return search(s, p, init, false)
end

function patterns.gmatch(s, p, init)
  local i, last = start_position(s, init), nil
  local m = matcher(s, compile(p, 1))
  return function()
    while i <= #s + 1 do
      local from, stop = i, m.match(i)
      if stop and stop ~= last then
        i, last = stop, stop
        return m.captures(from, stop, true)
      end
      i = i + 1
    end
    return nil
  end
end

local function expanded(m, by, from, stop)
  return (lib.gsub(by, '%%(.?)', function(d)
    if d == '%' then return d end
    if not find(d, '%d') then error("invalid use of '%' in replacement string", 0) end
    return d == '0' and m.whole(from, stop) or m.capture(tonumber(d), from, stop)
  end))
end

function patterns.gsub(s, p, by, max)
  lib.gsub('', 'x', by, max)                    -- raises what cannot replace
  local anchored = byte(p, 1) == ANCHOR
  local m = matcher(s, compile(p, anchored and 2 or 1))
  local parts, count, i, copied, last = {}, 0, 1, 1, nil
  local kind, limit = type(by), to_integer(tonumber(max or #s + 1))
  if kind == 'number' then by = by .. '' end
  while count < limit do
    local stop = m.match(i)
    if stop and stop ~= last then
      count = count + 1
      local value
      if kind == 'function' then
        value = by(m.captures(i, stop, true))
      elseif kind == 'table' then
        value = by[m.capture(1, i, stop)]
      else
        value = expanded(m, by, i, stop)
      end
      if not value then
        value = sub(s, i, stop - 1)
      elseif type(value) ~= 'string' and type(value) ~= 'number' then
        error('invalid replacement value (a ' .. type(value) .. ')', 0)
      end
      parts[#parts + 1] = sub(s, copied, i - 1)
      parts[#parts + 1] = value
      i, copied, last = stop, stop, stop
    elseif i <= #s then
      i = i + 1
    else
      break
    end
    if anchored then break end
  end
  parts[#parts + 1] = sub(s, copied)
  return concat(parts), count
end

return patterns
