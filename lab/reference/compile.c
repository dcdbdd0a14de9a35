/* compile.c: see compile.h. */
#include "lab/reference/compile.h"

#include "bake/base/process.h"
#include "image.h"

#include <ctype.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SECONDS = 120, PATH_SIZE = 128, CPP_MOST = 64 << 20 };

static const char *path_in(const ref_library *l, const char *name, char path[PATH_SIZE]) {
    snprintf(path, PATH_SIZE, "%s/%s", l->folder, name);
    return path;
}

static bool make_folder(ref_library *l, char *error, size_t size) {
    memset(l, 0, sizeof *l);
    snprintf(l->folder, sizeof l->folder, "/tmp/masu-reference-XXXXXX");
    if (mkdtemp(l->folder)) return true;
    l->folder[0] = 0;
    snprintf(error, size, "cannot make a folder in /tmp for the compiled field");
    return false;
}

/* First line of the program's output, starting at its first "error" if it has one. */
static void quote(char *said, char *out, size_t size) {
    char *from = strstr(said, "ERROR: ");
    if (!from) from = strstr(said, "error: ");
    if (!from) from = said;
    from[strcspn(from, "\n")] = 0;
    snprintf(out, size, "%s", from);
}

static bool run(const char *const *arguments, const char *package, char *error, size_t size) {
    masu_bake_buffer output = {0};
    masu_bake_result result = masu_bake_run(arguments, SECONDS, &output);
    bool good = result.end == MASU_BAKE_EXITED && result.code == 0;
    if (!good && result.end == MASU_BAKE_EXITED && result.code == MASU_BAKE_CANNOT_START) {
        snprintf(error, size, "cannot start %s, which compiles the field: install %s", arguments[0],
                 package);
    } else if (!good) {
        char line[256];
        masu_bake_append(&output, "", 1);
        quote((char *)output.data, line, sizeof line);
        snprintf(error, size, "%s cannot compile the field: %s", arguments[0], line);
    }
    masu_bake_release(&output);
    return good;
}

static bool load(ref_library *l, const char *object, char *error, size_t size) {
    l->handle = dlopen(object, RTLD_NOW | RTLD_LOCAL);
    if (!l->handle) snprintf(error, size, "cannot load the compiled field: %.200s", dlerror());
    return l->handle != NULL;
}

bool ref_compile_c(const char *text, ref_library *l, char *error, size_t size) {
    char source[PATH_SIZE], object[PATH_SIZE];
    if (!make_folder(l, error, size)) return false;
    path_in(l, "field.c", source);
    path_in(l, "field.so", object);
    const char *cc[] = {"cc",      "-std=c11", "-O2", "-w",   "-ffp-contract=off",
                        "-shared", "-fPIC",    "-o",  object, source,
                        "-lm",     NULL};
    return masu_file_write(source, text, strlen(text), error, size) &&
           run(cc, "gcc", error, size) && load(l, object, error, size);
}

/* ISO C has no conversion from an object pointer to a function pointer; POSIX has. */
bool ref_library_find(const ref_library *l, const char *name, void *to) {
    void *symbol = dlsym(l->handle, name);
    memcpy(to, &symbol, sizeof symbol);
    return symbol != NULL;
}

void ref_library_close(ref_library *l) {
    static const char *const files[] = {"field.c",   "field.so",       "field.comp", "field.spv",
                                        "field.cpp", "sdf/terms.glsl", "sdf"};
    char path[PATH_SIZE];
    if (l->handle) dlclose(l->handle);
    for (size_t i = 0; l->folder[0] && i < sizeof files / sizeof *files; i++)
        remove(path_in(l, files[i], path));
    if (l->folder[0]) rmdir(l->folder);
    memset(l, 0, sizeof *l);
}

/* ---- GLSL ------------------------------------------------------------------------------------ */

/* The functions that docs/scene.md and docs/sdf.md allow in a field's code, as defined there: all
 * terms and all parts are evaluated. */
static const char before_field[] =
    "#version 450\n"
    "#extension GL_GOOGLE_include_directive : require\n"
    "layout(local_size_x = 1) in;\n"
    "layout(set = 0, binding = 0, std430) buffer ref_inputs_block {\n"
    "    float time; float params[256]; float slots[65536]; } ref_inputs;\n"
    "layout(set = 0, binding = 1, std430) buffer ref_call_block {\n"
    "    float what; float part; float point[3]; float normal[3]; float value; float look[8];\n"
    "} ref_call;\n"
    "struct masu_surface { vec3 albedo; float roughness; vec3 emissive; float metallic; };\n"
    "vec3 masu_normal = vec3(0.0);\n"
    "float masu_param(int i) { return uint(i) < 256u ? ref_inputs.params[i] : 0.0; }\n"
    "float masu_time() { return ref_inputs.time; }\n"
    "float masu_slot(uint i) { return i < 65536u ? ref_inputs.slots[i] : 0.0; }\n"
    "void masu_slot_write(uint i, float v) { if (i < 65536u) ref_inputs.slots[i] = v; }\n"
    "uint masu_part_bits(int word) { return 0xFFFFFFFFu; }\n"
    "uint masu_part_count() { return 65536u; }\n"
    "uint masu_part_at(uint i) { return i; }\n"
    /* Terms */
    "void masu_terms_begin() {}\n"
    "void masu_terms_end() {}\n"
    "void masu_term_joined(int term, uint before, float joined, float e, float blend) {}\n"
    "bool masu_may_be_below(float low, float d) { return low < d; }\n"
    "bool masu_term(int term) { return true; }\n"
    "uint masu_terms_from(int term, int count) { return ((1u << count) - 1u) << term; }\n"
    "#define MASU_SDF_SETUP 1\n"
    "#define MASU_LOOP\n"
    "#define MASU_SDF_MARGIN 0.0\n"
    "#define masu_term_bits(word) 0xFFFFFFFFu\n"
    "#define MASU_KEEP_NONE\n"
    "#define MASU_KEEP_BEGIN\n"
    "#define MASU_KEEP_PART(d, f, word, bit)\n"
    "#define MASU_KEEP_ESTIMATE(d, part, safe)\n"
    "#define MASU_KEEP_TERMS(word, first)\n"
    "#define MASU_KEEP(bit)\n"
    "#define MASU_KEEP_LEAST(joined, e, lipschitz, blend, bit, before)\n"
    "#define MASU_KEEP_MOST(joined, e, lipschitz, blend, bit, before)\n"
    "#define MASU_KEEP_ALL(all, bits)\n"
    "#define MASU_KEPT\n"
    /* Functions that are defined for every operand */
    "const float masu_tiny = 1e-30;\n"
    "const float masu_huge = 1e30;\n"
    "bool masu_finite(float x) { return abs(x) < 3.4028235e38; }\n"
    "bool masu_finite(vec3 v) {\n"
    "    return masu_finite(v.x) && masu_finite(v.y) && masu_finite(v.z); }\n"
    "float masu_sane(float x, float lo, float hi) {\n"
    "    return clamp(masu_finite(x) ? x : 0.0, lo, hi); }\n"
    "vec3 masu_sane(vec3 v, float lo, float hi) {\n"
    "    return vec3(masu_sane(v.x, lo, hi), masu_sane(v.y, lo, hi), masu_sane(v.z, lo, hi)); }\n"
    "bool masu_finite(vec4 v) { return masu_finite(v.xyz) && masu_finite(v.w); }\n"
    "vec4 masu_sane(vec4 v, float lo, float hi) {\n"
    "    return vec4(masu_sane(v.xyz, lo, hi), masu_sane(v.w, lo, hi)); }\n"
    "float masu_sane_unit(float x) { return masu_sane(x, 0.0, 1.0); }\n"
    "vec3 masu_sane_unit(vec3 v) { return masu_sane(v, 0.0, 1.0); }\n"
    "float masu_rcp(float x) {\n"
    "    return masu_finite(x) && abs(x) > masu_tiny ? 1.0 / x : 0.0; }\n"
    "float masu_sqrt(float x) { return masu_finite(x) && x > 0.0 ? sqrt(x) : 0.0; }\n"
    "float masu_rsqrt(float x) {\n"
    "    return masu_finite(x) && x > masu_tiny ? 1.0 / sqrt(x) : 0.0; }\n"
    "float masu_rsqrt_sure(float x) { return 1.0 / sqrt(x); }\n"
    "float masu_log2(float x) { return log2(masu_finite(x) ? max(x, masu_tiny) : masu_tiny); }\n"
    "float masu_exp2(float x) { return exp2(masu_sane(x, -126.0, 126.0)); }\n"
    "float masu_pow(float x, float y) {\n"
    "    if (!masu_finite(y) || y == 0.0) return 1.0;\n"
    "    if (!masu_finite(x) || !(x > masu_tiny)) return 0.0;\n"
    "    return masu_exp2(log2(x) * clamp(y, -masu_huge, masu_huge)); }\n"
    "float masu_pow_above(float x, float y) { return exp2(log2(x) * y); }\n"
    "float masu_acos(float x) { return acos(masu_sane(x, -1.0, 1.0)); }\n"
    "float masu_atan2(float y, float x) {\n"
    "    float largest = max(abs(x), abs(y));\n"
    "    bool usable = masu_finite(x) && masu_finite(y) && largest > masu_tiny &&\n"
    "                  largest < masu_huge;\n"
    "    return usable ? sign(y) == 0.0 && x < 0.0 ? acos(-1.0) : atan(y, x) : 0.0; }\n"
    "uint masu_low_bit(uint bits) { return uint(findLSB(bits)); }\n"
    "vec3 masu_normalize(vec3 v, vec3 fallback) {\n"
    "    float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));\n"
    "    bool usable = masu_finite(v) && largest > masu_tiny && largest < masu_huge;\n"
    "    return usable ? normalize(v / largest) : fallback; }\n";

static const char after_field[] =
    "\nvoid main() {\n"
    "    vec3 p = vec3(ref_call.point[0], ref_call.point[1], ref_call.point[2]);\n"
    "    masu_normal = vec3(ref_call.normal[0], ref_call.normal[1], ref_call.normal[2]);\n"
    "#ifdef REF_PARTS\n"
    "    if (ref_call.what == 2.0) {\n"
    "        masu_sdf_update();\n"
    "    } else {\n"
    "        ref_call.value = masu_sdf_part(uint(ref_call.part), p);\n"
    "    }\n"
    "#else\n"
    "    if (ref_call.what == 1.0) {\n"
    "        masu_surface s = masu_surface(vec3(0.5), 0.5, vec3(0.0), 0.0);\n"
    "        masu_sdf_surface(p, s);\n"
    "        ref_call.look = float[](s.albedo.x, s.albedo.y, s.albedo.z, s.roughness,\n"
    "            s.emissive.x, s.emissive.y, s.emissive.z, s.metallic);\n"
    "    } else {\n"
    "        ref_call.value = masu_sdf(p);\n"
    "    }\n"
    "#endif\n"
    "}\n";

/* Declarations that SPIRV-Cross's C++ expects from headers that Debian does not package, and GLM's
 * double vectors under the names of the float vectors. */
static const char before_cpp[] =
    "#define GLM_FORCE_SWIZZLE\n"
    "#include <glm/glm.hpp>\n"
    "#include <array>\n"
    "#include <stdint.h>\n"
    "namespace spirv_cross {\n"
    "namespace internal {\n"
    "template <typename T> struct Resource {\n"
    "    T *at = nullptr;\n"
    "    T &get() const { return *at; }\n"
    "};\n"
    "}\n"
    "}\n"
    "struct spirv_cross_shader {\n"
    "    void *buffers[2];\n"
    "    template <typename T>\n"
    "    void register_resource(spirv_cross::internal::Resource<T> &r, unsigned,\n"
    "                           unsigned binding) {\n"
    "        r.at = static_cast<T *>(buffers[binding]);\n"
    "    }\n"
    "};\n"
    "namespace spirv_cross {\n"
    "struct ComputeResources {\n"
    "    void init(spirv_cross_shader &) {}\n"
    "};\n"
    "struct ComputePrivateResources {};\n"
    "}\n"
    "namespace glm {\n"
    "template <length_t L, qualifier Q>\n"
    "vec<L, uint, Q> floatBitsToUint(vec<L, double, Q> const &v) {\n"
    "    return floatBitsToUint(vec<L, float, Q>(v));\n"
    "}\n"
    "template <length_t L, qualifier Q>\n"
    "vec<L, int, Q> floatBitsToInt(vec<L, double, Q> const &v) {\n"
    "    return floatBitsToInt(vec<L, float, Q>(v));\n"
    "}\n"
    "}\n"
    "#define float double\n"
    "#define vec2 dvec2\n"
    "#define vec3 dvec3\n"
    "#define vec4 dvec4\n"
    "#define mat2 dmat2\n"
    "#define mat3 dmat3\n"
    "#define mat4 dmat4\n"
    "#define mat2x3 dmat2x3\n"
    "#define mat2x4 dmat2x4\n"
    "#define mat3x2 dmat3x2\n"
    "#define mat3x4 dmat3x4\n"
    "#define mat4x2 dmat4x2\n"
    "#define mat4x3 dmat4x3\n";

/* Replaces the interface at the end of that C++. A shader's private variables are members: one
 * object per call. */
static const char after_cpp[] = "extern \"C\" void ref_run(void *inputs, void *call) {\n"
                                "    spirv_cross_shader where = {{inputs, call}};\n"
                                "    Impl::Shader::Resources resources;\n"
                                "    Impl::Shader shader;\n"
                                "    resources.init(where);\n"
                                "    shader.__res = &resources;\n"
                                "    shader.main();\n"
                                "}\n";

/* Changes 1.5f, with the float's value, to 1.5. In place. */
static void drop_suffixes(char *text) {
    char *to = text, last = ' ';
    for (char *from = text; *from; last = *from++) {
        if (isdigit((unsigned char)*from) && !isalnum((unsigned char)last) && last != '_') {
            bool hexadecimal = from[0] == '0' && (from[1] == 'x' || from[1] == 'X');
            while (isalnum((unsigned char)*from) || *from == '.' ||
                   ((*from == '-' || *from == '+') && !hexadecimal &&
                    (from[-1] == 'e' || from[-1] == 'E')))
                *to++ = *from++;
            if (to[-1] == 'f' && !hexadecimal) to--;
            last = '0';
            if (!*from) break;
        }
        *to++ = *from;
    }
    *to = 0;
}

static bool write_shader(const ref_library *l, const char *text, const char *path, bool parts,
                         char *error, size_t size) {
    static const char terms[] = "/* everything is evaluated */\n";
    masu_bake_buffer all = {0};
    char name[PATH_SIZE];
    masu_bake_append_text(&all, before_field);
    if (parts) masu_bake_append_text(&all, "#define REF_PARTS\n");
    masu_bake_append_text(&all, "#line 1 \"");
    for (const char *c = path; *c; c++)
        masu_bake_append(&all, *c == '"' || *c == '\\' || (unsigned char)*c < 0x20 ? "?" : c, 1);
    masu_bake_append_text(&all, "\"\n");
    masu_bake_append_text(&all, text);
    masu_bake_append_text(&all, after_field);
    mkdir(path_in(l, "sdf", name), 0700);
    bool good =
        masu_file_write(path_in(l, "sdf/terms.glsl", name), terms, sizeof terms - 1, error, size) &&
        masu_file_write(path_in(l, "field.comp", name), all.data, all.bytes, error, size);
    masu_bake_release(&all);
    return good;
}

static bool finish_cpp(const char *file, char *error, size_t size) {
    uint8_t *data = NULL;
    size_t bytes;
    if (!masu_file_read(file, CPP_MOST, &data, &bytes, error, size)) return false;
    masu_bake_buffer all = {0}, made = {0};
    masu_bake_append(&made, data, bytes);
    masu_bake_append(&made, "", 1);
    free(data);
    char *from = strstr((char *)made.data, "using namespace spirv_cross;"),
         *end = from ? strstr(from, "spirv_cross_shader_t *spirv_cross_construct") : NULL;
    bool good = end != NULL;
    if (good) {
        *end = 0;
        drop_suffixes(from);
        masu_bake_append_text(&all, before_cpp);
        masu_bake_append_text(&all, from);
        masu_bake_append_text(&all, after_cpp);
        good = masu_file_write(file, all.data, all.bytes, error, size);
    } else {
        snprintf(error, size, "spirv-cross: its C++ is not of the expected form (that of 2021)");
    }
    masu_bake_release(&all);
    masu_bake_release(&made);
    return good;
}

bool ref_compile_glsl(const char *text, const char *path, bool parts, ref_library *l,
                      ref_glsl_run **out, char *error, size_t size) {
    char source[PATH_SIZE], spirv[PATH_SIZE], cpp[PATH_SIZE], object[PATH_SIZE], here[PATH_SIZE],
        beside[1024];
    if (!make_folder(l, error, size)) return false;
    path_in(l, "field.comp", source);
    path_in(l, "field.spv", spirv);
    path_in(l, "field.cpp", cpp);
    path_in(l, "field.so", object);
    snprintf(here, sizeof here, "-I%s", l->folder);
    const char *slash = strrchr(path, '/');
    snprintf(beside, sizeof beside, "-I%.*s", slash ? (int)(slash - path + 1) : 1,
             slash ? path : ".");
    const char *to_spirv[] = {
        "glslangValidator", "-V", "-S", "comp", here, beside, "-o", spirv, source, NULL};
    const char *to_cpp[] = {"spirv-cross", "--cpp", "--output", cpp, spirv, NULL};
    const char *to_object[] = {"g++",     "-std=c++17", "-O2", "-w",   "-ffp-contract=off",
                               "-shared", "-fPIC",      "-o",  object, cpp,
                               NULL};
    bool good = write_shader(l, text, path, parts, error, size) &&
                run(to_spirv, "glslang-tools", error, size) &&
                run(to_cpp, "spirv-cross", error, size) && finish_cpp(cpp, error, size) &&
                run(to_object, "g++ and libglm-dev", error, size) && load(l, object, error, size);
    if (good && !ref_library_find(l, "ref_run", out)) {
        snprintf(error, size, "the compiled field lacks a function");
        good = false;
    }
    return good;
}
