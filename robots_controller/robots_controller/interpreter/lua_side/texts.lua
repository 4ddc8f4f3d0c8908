-- Texts of values, the same ones in every run.

-- Lua shows a value without a text of its own as its address, which differs in every process. Here
-- such values are numbered, in the order in which they are first asked for.
local ADDRESSED = {table = true, ['function'] = true, thread = true}
local numbers, last_number = setmetatable({}, {__mode = 'k'}), 0

local function text_of(...)
  local text, value = tostring(...), ...
  if ADDRESSED[type(value)] then
    local address = format('%p', value)
    if sub(text, -#address) == address then
      if not numbers[value] then
        last_number = last_number + 1
        numbers[value] = last_number
      end
      return sub(text, 1, -#address - 1) .. numbers[value]
    end
  end
  return text
end

local function format_text(form, ...)
  local values, n = nil, 0
  if type(form) == 'string' then
    for conversion in gmatch(form, '%%[^%a%%]*(.)') do
      if conversion ~= '%' then
        n = n + 1
        if conversion == 'p' then
          fail("string.format: '%p' is an address, another one in every run; '%s' numbers a value")
        elseif conversion == 's' and ADDRESSED[type((select(n, ...)))] then
          values = values or pack(...)
          values[n] = text_of(values[n])
        end
      end
    end
  end
  if values then return format(form, unpack(values, 1, values.n)) end
  return format(form, ...)
end

