-- Robot functions that need Lua: those that take or return functions, and poses.

local special, MAX_PRINT = {}, 9900

function special.print(...)
  local words = pack(...)
  for i = 1, words.n do words[i] = text_of(words[i]) end
  local text = concat(words, '\t')
  if #text > MAX_PRINT then text = sub(text, 1, MAX_PRINT) .. '... (' .. #text .. ' bytes)' end
  call('print', {text}, 1)
end

function special.timer(...)
  local start = call('timer', {...}, select('#', ...))
  return function() return call('getTime', {}, 0) - start end
end

local PLACES = {x = 1, y = 2, z = 3, phi1 = 4, phi2 = 5, phi3 = 6}
POSE.__metatable = false
function POSE.__index(pose, key) return rawget(pose, PLACES[key]) end
function POSE.__newindex(pose, key, value) rawset(pose, PLACES[key] or key, value) end
function POSE.__mul(a, b) return call('compose', {a, b}, 2) end
function POSE.__tostring(pose)
  local texts = {}
  for i = 1, 6 do texts[i] = format('%.9g', floor(pose[i] * 1e6 + 0.5) / 1e6) end
  return '{' .. concat(texts, ', ') .. '}'
end

function special.grid(...) return {call('grid', {...}, select('#', ...))} end

for function_name, place in pairs {onDigitalInput = 3, onAnalogInput = 4} do
  special[function_name] = function(...)
    local id = call(function_name, {...}, select('#', ...))
    handlers[id] = {run = select(place, ...), function_name = function_name}
    return id
  end
end

function special.removeInterrupt(...)
  call('removeInterrupt', {...}, select('#', ...))
  handlers[floor((...))] = nil
end

-- Motions are named to Python: no function leaves Lua.
local motion_names = {}

function special.moveUntil(condition, motion, ...)
  motion = motion_names[motion] or motion
  local met, stands, place = call('moveUntil', {condition, motion, ...}, select('#', ...) + 2)
  return met[1] == 1, stands, place
end

local MAX_SUBPROGRAMS, nesting = 100, 0
local leave_subprogram = setmetatable({}, {__close = function() nesting = nesting - 1 end})

local function loaded(answer)
  local chunk, text = string.match(answer, '^([^\n]*)\n(.*)$')
  sources['=' .. chunk] = chunk
  local program, problem = load(text, '=' .. chunk, 't', env)
  if not program then error(problem, 0) end
  return program
end

local describe
local FAILURE = {__tostring = function(failure) return failure.reason end}

function special.startTask(...)
  local answer = call('startTask', {...}, select('#', ...))
  local number, rest = string.match(answer, '^(%d+)\n(.*)$')
  local program, arguments = loaded(rest), pack(select(2, ...))
  local co = create(function()
    local ok, failure = xpcall(program, describe, unpack(arguments, 1, arguments.n))
    if not ok then return failure end
  end)
  sethook(co, hook, '', count)
  tasks[tonumber(number)] = co
  task_news = tonumber(number)
  attend_now()
end

function special.call(...)
  local program = loaded(call('call', {...}, select('#', ...)))
  if nesting == MAX_SUBPROGRAMS then
    fail('call: subprograms call each other more than ' .. MAX_SUBPROGRAMS .. ' deep')
  end
  nesting = nesting + 1
  local _ <close> = leave_subprogram
  return program(select(2, ...))
end

