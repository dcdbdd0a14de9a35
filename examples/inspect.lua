-- inspect.lua LIBRARY CDEF SCENE.masu [ABI]: Masu from LuaJIT: prints the contents of a scene and the resolved
-- description. It needs no Vulkan device. The declarations are generated: package/cdef.sh writes CDEF from masu.h.
-- With ABI (tests/consumers/abi.txt) it compares LuaJIT's own layout of every struct with the list.
local ffi = require("ffi")

local function read(path)
    local file = assert(io.open(path, "rb"))
    local bytes = file:read("*a")
    file:close()
    return bytes
end

if #arg < 3 then
    io.stderr:write("usage: luajit inspect.lua LIBRARY CDEF SCENE.masu [ABI]\n")
    os.exit(2)
end
ffi.cdef(read(arg[2]))
local masu = ffi.load(arg[1])

-- Every fallible function has a masu_detail as its last argument: an error becomes a Lua error.
local detail = ffi.new("masu_detail")
local function call(name, ...)
    local arguments = {...}
    arguments[#arguments + 1] = detail
    local result = tonumber(masu[name](unpack(arguments)))
    if result < 0 then error(name .. ": " .. ffi.string(detail.text), 0) end
    return result
end

-- A description with its size, like MASU_DESC in C.
local function desc()
    local d = ffi.new("masu_desc")
    d.bytes = ffi.sizeof("masu_desc")
    return d
end

-- ---- The scene ----------------------------------------------------------------------------------

local text = read(arg[3])
local room = ffi.new("uint8_t[?]", #text + 16) -- the blob is aligned to 16 bytes
local from = tonumber(ffi.cast("uintptr_t", room) % 16)
local blob = room + (16 - from)
ffi.copy(blob, text, #text)
local scene = ffi.new("masu_scene")
call("masu_scene_bind", blob, #text, scene)

local version = masu.masu_version()
print(string.format("masu %d.%d.%d", math.floor(version / 1000000), math.floor(version / 1000) % 1000, version % 1000))
print("class " .. ffi.string(masu.masu_scene_class_name(masu.masu_scene_class_of(scene))))
for _, kind in ipairs {"INSTANCE", "MODEL", "LIGHT", "MATERIAL", "SDF_PARAM"} do
    local item, names = ffi.cast("masu_scene_item", ffi.C["MASU_SCENE_" .. kind]), {}
    local count = masu.masu_scene_count(scene, item)
    for i = 0, math.min(count, 4) - 1 do names[#names + 1] = ffi.string(masu.masu_scene_name(scene, item, i)) end
    print(string.format("%-10s %d %s", kind:lower(), count, table.concat(names, " ")))
end

local needs, limit = ffi.new("masu_limits"), masu.masu_limit_table()
masu.masu_scene_usage(scene, needs)
while limit.name ~= nil do
    local value = ffi.cast("uint64_t *", ffi.cast("uint8_t *", needs) + limit.offset)[0]
    if value > 0 then print(string.format("%-18s %s", ffi.string(limit.name), tostring(value):gsub("ULL", ""))) end
    limit = limit + 1
end

-- ---- A description ------------------------------------------------------------------------------

local d = desc()
d.scene, d.output.width, d.output.height = scene, 1280, 720
call("masu_desc_resolve", d, d)
for r = 0, d.rung_count - 1 do print(string.format("rung %d: scale %.2f", r, d.rungs[r].scale)) end

d.bytes = d.bytes - 8
local good, message = pcall(call, "masu_desc_resolve", d, d)
assert(not good)
print(message)

-- ---- Layouts ------------------------------------------------------------------------------------

local same, differ = 0, 0
for line in arg[4] and io.lines(arg[4]) or function() end do
    local struct, size = line:match("^struct (%S+) (%d+)$")
    local type, member, at = line:match("^member ([%w_]+)%.([%w_]+) at (%d+),")
    local is = struct and ffi.sizeof(struct) or type and ffi.offsetof(type, member)
    if is == tonumber(size or at) then
        same = same + (is and 1 or 0)
    else
        differ = differ + 1
        print(line .. ": " .. tostring(is) .. " in LuaJIT")
    end
end
if arg[4] then print(string.format("layouts: %d alike, %d differ", same, differ)) end
os.exit(differ == 0)
