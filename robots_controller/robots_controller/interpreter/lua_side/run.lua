-- The sandbox, last part: runs the program and describes its failure.

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
  if not program then return name, 0, problem, '' end
  local ok, failure = xpcall(function()
    sethook(hook, '', count)
    trace(ask())                        -- the first line reports what is due at the start
    program()
    call('', {}, 0)                     -- the program ends when the robot stands
  end, describe)
  sethook()
  if ok or stopped then return nil end
  if type(failure) == 'table' then
    return failure.chunk, failure.line, failure.reason, failure.stack
  end
  return name, 0, tostring(failure), ''
end
