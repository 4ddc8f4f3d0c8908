-- What describes a held program: its calls and variables.

local builtin = {}
local env
local MAX_FRAMES, MAX_VARIABLES, MAX_ENTRIES, MAX_TEXT, MAX_DEPTH, MAX_RECORDS = 20, 50, 30, 200, 3, 2000

-- Records of four texts: what, name, value, detail. No metamethod is called.
local function record(records, ...)
  local n = #records
  records[n + 1], records[n + 2], records[n + 3], records[n + 4] = ...
end

local function describe_variable(records, level, key, value)
  if #records >= 4 * MAX_RECORDS then return end
  local kind, shown = type(value), nil
  if kind == 'string' then
    shown = "'" .. sub(value, 1, MAX_TEXT) .. (#value > MAX_TEXT and '...' or '') .. "'"
  elseif kind == 'table' then
    shown = 'table with ' .. rawlen(value) .. ' values'
  elseif kind == 'function' then
    local info = getinfo(value, 'S')
    shown = sources[info.source] and 'function of line ' .. info.linedefined or 'function of the robot'
  elseif kind == 'thread' then
    shown = 'coroutine'
  else
    shown = tostring(value)
  end
  record(records, level .. '', key, shown, kind)
  if kind == 'table' and level < MAX_DEPTH then
    local entries = 0
    for k, v in next, value do
      entries = entries + 1
      if entries > MAX_ENTRIES then break end
      local text = type(k) == 'string' and sub(k, 1, MAX_TEXT)
        or type(k) == 'number' and '[' .. k .. ']' or '[' .. type(k) .. ']'
      describe_variable(records, level + 1, text, v)
    end
  end
end

local function snapshot()
  local records, frames, level = {}, 0, 2
  while frames < MAX_FRAMES do
    local info = getinfo(level, 'Slnf')
    if not info then break end
    local chunk = sources[info.source]
    if chunk then
      frames = frames + 1
      record(records, 'frame', frame_name(info), chunk, info.currentline .. '')
      record(records, 'scope', 'Locals', '', '')
      local seen, names, i = {}, {}, 1
      while i <= 250 do
        local key, value = getlocal(level, i)
        if not key then break end
        if sub(key, 1, 1) ~= '(' then
          if not seen[key] then names[#names + 1] = key end
          seen[key] = {value}                   -- a later one of the same name hides the earlier
        end
        i = i + 1
      end
      for k = 1, #names <= MAX_VARIABLES and #names or MAX_VARIABLES do
        describe_variable(records, 0, names[k], seen[names[k]][1])
      end
      record(records, 'scope', 'Upvalues', '', '')
      for k = 1, MAX_VARIABLES do
        local key, value = getupvalue(info.func, k)
        if not key then break end
        if key ~= '_ENV' then describe_variable(records, 0, key, value) end
      end
    end
    level = level + 1
  end
  record(records, 'depth', '', '', depth() .. '')
  record(records, 'scope', 'Globals', '', '')
  local n = 0
  for key, value in next, env do
    if type(key) == 'string' and builtin[key] == nil then
      n = n + 1
      if n > MAX_VARIABLES then break end
      describe_variable(records, 0, key, value)
    end
  end
  return records
end

