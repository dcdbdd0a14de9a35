/* ops.c: the table of operations, made of library.inc twice: run here in double
 * precision, and as text. The names that GLSL has and C lacks are made up for below. */
#include "sdfc/internal.h"

/* C versions of GLSL's built-in functions and shared/guard.glsl: compiled here, and also the
 * beginning of every generated C reference. */
#define PRELUDE(...)                                                                               \
    __VA_ARGS__                                                                                    \
    static const char prelude_text[] = #__VA_ARGS__;

/* clang-format off */
PRELUDE(
typedef double real;
static inline real lib_min(real a, real b) { return b < a ? b : a; }
static inline real lib_max(real a, real b) { return a < b ? b : a; }
static inline real lib_mix(real a, real b, real t) { return a * (1.0 - t) + b * t; }
static inline real masu_rcp(real x) { return fabs(x) > 1e-30 && isfinite(x) ? 1.0 / x : 0.0; }
static inline real masu_sqrt(real x) { return x > 0.0 && isfinite(x) ? sqrt(x) : 0.0; }
static inline real masu_atan2(real y, real x) { return isfinite(x) && isfinite(y) ? atan2(y, x) : 0.0; }
static inline real masu_pow(real x, real y) { return x > 1e-30 && isfinite(x) ? exp2(lib_min(lib_max(y * log2(x), -126.0), 126.0)) : (y == 0.0 ? 1.0 : 0.0); }
static inline real masu_log2(real x) { return log2(x > 1e-30 && isfinite(x) ? x : 1e-30); }
)

typedef uint32_t uint;
#define T(name, count, text, code)
#define F(name, count, params, ...) static inline real masu_h_##name params __VA_ARGS__
#define min lib_min
#define max lib_max
#define mix lib_mix
#define abs fabs
#define uint(x) ((uint32_t)(x))
#define real(x) ((real)(x))
#define TO_INT(x) ((int32_t)((x) == (x) ? (x) : 0.0))
#include "sdfc/library.inc"
#undef T
#undef F

#define A(k) (i->operand[k] >= 0 ? v[i->operand[k]] : values[args[~i->operand[k]]])
#define READ_1 {A(0)}
#define READ_2 {A(0), A(1)}
#define READ_3 {A(0), A(1), A(2)}
#define READ_4 {A(0), A(1), A(2), A(3)}
#define READ_5 {A(0), A(1), A(2), A(3), A(4)}
#define READ_6 {A(0), A(1), A(2), A(3), A(4), A(5)}
#define READ_7 {A(0), A(1), A(2), A(3), A(4), A(5), A(6)}
#define READ_8 {A(0), A(1), A(2), A(3), A(4), A(5), A(6), A(7)}
#define READ_9 {A(0), A(1), A(2), A(3), A(4), A(5), A(6), A(7), A(8)}
#define READ_11 {A(0), A(1), A(2), A(3), A(4), A(5), A(6), A(7), A(8), A(9), A(10)}
#define READ_12 {A(0), A(1), A(2), A(3), A(4), A(5), A(6), A(7), A(8), A(9), A(10), A(11)}
#define READ_13 {A(0), A(1), A(2), A(3), A(4), A(5), A(6), A(7), A(8), A(9), A(10), A(11), A(12)}
#define CALL_1(f) f(a[0])
#define CALL_2(f) f(a[0], a[1])
#define CALL_3(f) f(a[0], a[1], a[2])
#define CALL_4(f) f(a[0], a[1], a[2], a[3])
#define CALL_5(f) f(a[0], a[1], a[2], a[3], a[4])
#define CALL_6(f) f(a[0], a[1], a[2], a[3], a[4], a[5])
#define CALL_7(f) f(a[0], a[1], a[2], a[3], a[4], a[5], a[6])
#define CALL_8(f) f(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7])
#define CALL_9(f) f(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8])
#define CALL_11(f) f(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10])
#define CALL_12(f) f(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10], a[11])
#define CALL_13(f) f(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10], a[11], a[12])
#define OPERANDS const sdfc_instr *i, const double *v, const int *args, const double *values
#define T(name, count, text, code) static double run_##name(OPERANDS) { const double a[] = READ_##count; return code; }
#define F(name, count, params, ...) static double run_##name(OPERANDS) { const double a[] = READ_##count; return CALL_##count(masu_h_##name); }
#include "sdfc/library.inc"
#undef T
#undef F
#undef min
#undef max
#undef mix
#undef abs
#undef uint
#undef real

const sdfc_op_info sdfc_ops[SDFC_OP_COUNT] = {
    [SDFC_CONST] = {"const", 0, NULL, NULL, NULL, NULL},
    [SDFC_PARAM] = {"param", 0, NULL, NULL, NULL, NULL},
    [SDFC_ANCHOR] = {"anchor", 0, NULL, NULL, NULL, NULL},
    [SDFC_POINT] = {"point", 0, NULL, NULL, NULL, NULL},
    [SDFC_WORLD] = {"world", 0, NULL, NULL, NULL, NULL},
    [SDFC_NORMAL] = {"normal", 0, NULL, NULL, NULL, NULL},
    [SDFC_TRAP] = {"trap", 0, NULL, NULL, NULL, NULL},
    [SDFC_FOOTPRINT] = {"footprint", 0, NULL, NULL, NULL, NULL},
    [SDFC_CELL] = {"cell", 0, NULL, NULL, NULL, NULL},
    [SDFC_INPUT] = {"input", 0, NULL, NULL, NULL, NULL},
    [SDFC_TIME] = {"time", 0, NULL, NULL, NULL, NULL},
#define T(name, count, text, code) [SDFC_##name] = {#name, count, text, NULL, NULL, run_##name},
#define F(name, count, params, ...) [SDFC_##name] = {#name, count, NULL, #params, #__VA_ARGS__, run_##name},
#include "sdfc/library.inc"
#undef T
#undef F
    [SDFC_CALL_MIN] = {"call_min", 0, NULL, NULL, NULL, NULL},
    [SDFC_CALL_NEAREST] = {"call_nearest", 0, NULL, NULL, NULL, NULL},
    [SDFC_CALL_USER] = {"call_user", 0, NULL, NULL, NULL, NULL},
};
/* clang-format on */

int sdfc_run_ops(const sdfc_instr *instrs, int count, const double *variables, const int *args,
                 const double *values, double *to) {
    for (int k = 0; k < count; k++) {
        const sdfc_op_info *info = &sdfc_ops[instrs[k].op];
        if (!info->run) return k;
        to[k] = info->run(&instrs[k], variables, args, values);
    }
    return count;
}

double sdfc_run_op(int op, const int32_t *operand, const double *values) {
    sdfc_instr i;
    double out = 1e30;
    i.op = op;
    for (int k = 0; k < sdfc_ops[op].operands; k++) i.operand[k] = operand[k];
    sdfc_run_ops(&i, 1, values, NULL, NULL, &out);
    return out;
}

const char *const sdfc_c_prelude = prelude_text;
