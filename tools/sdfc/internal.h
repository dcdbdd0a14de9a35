/* internal.h: declarations common to the files of the SDF compiler; see sdfc.h. */
#ifndef MASU_SDFC_INTERNAL_H
#define MASU_SDFC_INTERNAL_H

#include "sdfc/sdfc.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#if defined(__GNUC__)
#define SDFC_PRINTF(text, first) __attribute__((format(printf, text, first)))
#define SDFC_NORETURN __attribute__((noreturn))
#else
#define SDFC_PRINTF(text, first)
#define SDFC_NORETURN
#endif

/* Steepest gradient of noise() of the library, proved by test_sdf_shapes.c; attained: 3. */
#define SDFC_NOISE_SLOPE 3.001
#define SDFC_INFINITY ((double)INFINITY) /* <math.h>'s is a float */
#define SDFC_OPERANDS_MAX 27
#define SDFC_SECTORS_MAX 4096
#define SDFC_COPIES_MAX 16 /* around an axis, the same */
#define SDFC_CELLS_MAX 4 /* copies in a row that a repetition evaluates */
#define SDFC_EXPRS_MAX (1 << 20)
#define SDFC_SHAPES_MAX (1 << 17)
#define SDFC_SYMBOLS_MAX 4096
#define SDFC_WORK_MAX 8000000 /* tokens read, loops included */
#define SDFC_TREE_MAX 2048    /* shapes within one part */
#define SDFC_COST_MAX 20000.0 /* operations to evaluate one part once */
#define SDFC_COST_ALL_MAX 4e6 /* all parts once */
#define SDFC_INSTRS_MAX (1 << 20)
#define SDFC_CHILDREN_MAX 64

/* ---- operations (ops.c) ---- */

enum sdfc_op {
    SDFC_CONST,
    SDFC_PARAM,
    SDFC_ANCHOR, /* a[0]: axis */
    /* Local to a surface point or a cell: computed from operations, never from slots
     * (lower_local.c). */
    SDFC_POINT, SDFC_WORLD, SDFC_NORMAL, SDFC_TRAP, /* a[0]: axis */
    SDFC_FOOTPRINT,
    /* a[0]: the repetition, -1: the innermost; a[1]: the channel, -1: the number of the sector */
    SDFC_CELL,
    SDFC_INPUT, /* of a function: which cell it is called in */
    SDFC_TIME,
#define T(name, count, text, code) SDFC_##name,
#define F(name, count, params, ...) SDFC_##name,
#include "sdfc/library.inc"
#undef T
#undef F
    /* The least of a function's values at up to 64 points: up to 4 coordinates on each axis. */
    SDFC_CALL_MIN,
    SDFC_CALL_NEAREST, /* the number of the point that has it */
    SDFC_CALL_USER,
    SDFC_OP_COUNT
};

struct sdfc_instr;
typedef struct sdfc_op_info {
    const char *name;
    int operands;
    const char *text;          /* template, or NULL */
    const char *params, *body; /* of a function, or NULL */
    double (*run)(const struct sdfc_instr *instr, const double *variables, const int *args,
                  const double *values); /* NULL: not of library.inc */
} sdfc_op_info;

extern const sdfc_op_info sdfc_ops[SDFC_OP_COUNT];
extern const char *const sdfc_c_prelude;
double sdfc_run_op(int op, const int32_t *operand, const double *values); /* of library.inc */

/* ---- tokens ---- */

typedef enum sdfc_token_kind {
    TOKEN_END,
    TOKEN_NAME,
    TOKEN_NUMBER,
    TOKEN_MARK,
    TOKEN_RAW
} sdfc_token_kind;

typedef struct sdfc_token {
    sdfc_token_kind kind;
    uint32_t offset, length; /* in the text; for a raw block: of the text between its braces */
    uint32_t line, column;
    double number;
    char mark; /* ':' for "..", else the character... see TOKEN_DOTS */
} sdfc_token;
#define TOKEN_DOTS '~'

/* ---- expressions ---- */

typedef struct sdfc_expr {
    int32_t op, a[3];        /* PARAM: a[0] is its index */
    bool dynamic;            /* depends on parameters, time or the anchor */
    bool timed;              /* on parameters or time */
    bool anchored;           /* on the anchor */
    bool local;              /* on where it is evaluated */
    bool cellular, trapped;  /* on the innermost cell there, on the orbit trap of a fractal's
                              * levels */
    double slope; /* Lipschitz constant of a local expression in the point; INFINITY: unknown */
    double value, low, high; /* value: at the parameters' defaults and time 0 */
} sdfc_expr;

/* ---- shapes ---- */

typedef struct sdfc_box {
    double low[3], high[3];
} sdfc_box;

/* Properties of a field f that hold for all parameters and times:
 *
 *   |f(p) - f(q)| <= lipschitz |p - q|
 *   f(p) >= growth * distance(p, box), and the same for the sphere
 *   f does not change when p is mirrored in an axis of `symmetric` (bits 1 2 4)
 *   f does not decrease with |p_i| on the axes of `rising`, a subset of these */
typedef struct sdfc_facts {
    double lipschitz, growth;
    sdfc_box box;
    double center[3], radius; /* INFINITY: unbounded */
    unsigned symmetric, rising;
    bool user;     /* holds a glsl block: cannot be run here */
    bool estimate; /* f / lipschitz only nearly never exceeds the distance */
    bool truth;    /* has C */
    double cost;
    int depth, size;
} sdfc_facts;

typedef struct sdfc_shape {
    int kind;       /* index into sdfc_kinds */
    int number[16]; /* expressions */
    int cell;       /* of a repetition that has a name: its number + 1 */
    int paint;      /* PAINT: the material */
    int whole[4];   /* compile-time integers */
    int *child;
    int children;
    int user;         /* index of its glsl block */
    int token;        /* position in the text */
    double extra[16]; /* constants that the analysis adds */
    sdfc_facts facts;
} sdfc_shape;

typedef struct sdfc_user {
    uint32_t glsl_offset, glsl_length, c_offset, c_length;
    bool has_c;
    int token; /* of the block, for messages */
} sdfc_user;

enum {
#define KIND(id, ...) SDFC_KIND_##id,
#include "sdfc/kinds.inc"
#undef KIND
    SDFC_KIND_COUNT
};
typedef struct sdfc_kind {
    const char *name, *pattern, *arguments, *meaning, *lipschitz, *distance;
} sdfc_kind;
extern const sdfc_kind sdfc_kinds[SDFC_KIND_COUNT];
static inline bool sdfc_is_join(int kind) {
    return kind >= SDFC_KIND_UNION && kind <= SDFC_KIND_BLEND;
}

/* ---- compiled parts ---- */

typedef struct sdfc_instr {
    int32_t op;
    int32_t aux;                        /* CALL_MIN: the function, CALL_USER: the block */
    int32_t operand[SDFC_OPERANDS_MAX]; /* >= 0: a variable, < 0: argument ~operand */
    int32_t select[3];                  /* CALL_MIN: the first bit of the point's number that
                                           chooses, from 1; 0: none */
    int32_t bits[3];                    /* CALL_MIN: how many bits choose: 0, 1 or 2 */
    int32_t points;                     /* CALL_MIN; operands 4 axis + 0..3: the coordinates,
                                           nearest cell first; 12..14, for each axis: 15 * (this -
                                           |the own coordinate|) is the least value of its other
                                           cells, with + of all except the second; 16: the least of
                                           cells that are not evaluated; 17: the constant of the
                                           values per metre of the world; 18..20: the coordinates
                                           before the fold; 21..23: 1 / period or 0; 24..26: cells
                                           around it */
    int16_t named, around; /* CALL_MIN: whether the function takes its own cell (1: of 18
                                           to 23; 2: sector 18, of the odd points 19), and of how
                                           many around it */
} sdfc_instr;

/* Runs the operations of library.inc up to the first other one; returns their number. The value of
 * argument k is values[args[k]]; results go to `to`, which are later operations' variables. */
int sdfc_run_ops(const sdfc_instr *instrs, int count, const double *variables, const int *args,
                 const double *values, double *to);

/* A term: operations that are skipped if the other operand of their join alone determines the
 * result (terms.c). They end with the joining operation; the first term of a join ends with its own
 * value. */
typedef struct sdfc_term {
    int first, last; /* operations */
    int bit;         /* of its part's terms, or -1: always evaluated */
    int before;      /* number of bits of the same join's terms before it */
    int smooth;      /* the argument (~operand) that is the radius of the blend, or 0 */
    /* instead of a bit: evaluated where its other operand exceeds this argument (~operand) */
    int cap;
    bool opens;      /* the first of its join */
    bool far; /* if skipped, its value is an infinite distance, instead of the join keeping its
               * previous value */
    bool most;       /* the join takes the larger value */
    double lipschitz; /* of the term and of the other operand, per metre in world space */
} sdfc_term;

typedef struct sdfc_function {
    sdfc_instr *instrs;
    int count, capacity;
    sdfc_term *terms; /* inner terms come before outer ones */
    int term_count, term_capacity;
    int inputs; /* the first operations: cells that it is called in */
    int result; /* operand */
    int first_variable;
} sdfc_function;

/* A step of a part's root transform, the outermost operators of the part. */
typedef struct sdfc_root_step {
    int kind;   /* SDFC_KIND_TRANSLATE, _ROTATE or _SCALE */
    int arg[9]; /* arguments: the offset; the matrix; the factors, inverted */
} sdfc_root_step;

typedef struct sdfc_program {
    sdfc_root_step *root; /* from the world inwards */
    int root_count, root_capacity;
    sdfc_function *functions; /* the first one is the part's */
    int function_count, function_capacity;
    int *args; /* expressions */
    int arg_count, arg_capacity;
    int variable_count;
    /* the function that makes the material where it is not the same everywhere; 0: none */
    int surface;
    int look[8];            /* its results: operands */
} sdfc_program;

typedef struct sdfc_part {
    char name[MASU_SDFC_NAME_MAX];
    int shape, material, token;
    sdfc_program program;
    int group;
    uint32_t slot_base;
    bool moves; /* the part moves as a whole: its sphere moves with it, instead of containing all
                 * its positions */
    int moving_center[3]; /* expressions */
    double moving_radius;
} sdfc_part;

typedef struct sdfc_group {
    int first_part, part_count;
    int *slot_of_arg; /* -1: a literal */
    int slot_count;
    /* bits of each part's terms; of the first part, then part by part */
    int first_term, term_count;
    bool flat;  /* half-spaces: f is affine in the point */
    bool moves; /* a root transform of its parts changes */
} sdfc_group;

typedef struct sdfc_material {
    char name[MASU_SDFC_NAME_MAX];
    int value[MASU_SDFC_MATERIAL_SLOTS];
    bool local, cellular; /* depends on the point of evaluation, on the innermost cell */
} sdfc_material;

typedef struct sdfc_value {
    int count; /* 1, 2 or 3 */
    int e[3];
} sdfc_value;

typedef enum sdfc_symbol_kind {
    SYMBOL_LET,
    SYMBOL_SHAPE,
    SYMBOL_MATERIAL,
    SYMBOL_DEF,
    SYMBOL_CELL,
    SYMBOL_BROKEN /* its declaration is wrong */
} sdfc_symbol_kind;

#define SDFC_ARGUMENTS_MAX 16
/* def NAME(...) = body; a call reads the body's tokens again. */
typedef struct sdfc_def {
    int body; /* token */
    int argument[SDFC_ARGUMENTS_MAX], fallback[SDFC_ARGUMENTS_MAX], count; /* tokens; 0: none */
    int symbols; /* declared before it */
    bool is_shape;
} sdfc_def;

/* A file's text in the text of all. */
typedef struct sdfc_file {
    char name[256];
    uint32_t begin;
} sdfc_file;

typedef struct sdfc_symbol {
    uint32_t offset, length;
    sdfc_symbol_kind kind;
    sdfc_value value; /* count of a cell: of sectors, 0: not around an axis */
    int index;
} sdfc_symbol;

/* A slot that is a constant sum of the anchor's coordinates, modulo a period if that is not 0.
 * Stored as data: a scene has thousands of them, and as code they would take an optimiser too
 * long. */
typedef struct sdfc_place {
    uint32_t slot;
    double factor[3], term, period, inverse;
} sdfc_place;
/* a Mandelbulb of no more: its estimate is a bound, and a better one */
enum { SDFC_SHALLOW_LEVELS = 2 };
enum { SDFC_PLACE_SLOTS = 12 }; /* the slot, then the rest in two floats each, inverse in one */

typedef struct sdfc_text {
    char *data;
    size_t length, capacity;
} sdfc_text;

typedef struct sdfc {
    jmp_buf failed, statement;
    bool in_statement; /* a mistake ends this only */
    const char *text, *name;
    size_t bytes;
    char *joined; /* the text, if it includes others */
    sdfc_file *files;
    int file_count, file_capacity;
    uint32_t file_end;
    char *error;
    size_t error_size, error_length;
    int errors;
    int open_kind;  /* the shape whose arguments are read, or -1 */
    int call_token; /* of the def that is being expanded, or -1 */
    sdfc_def *defs;
    int def_count, def_capacity;
    int hidden_from, hidden_to; /* symbols that a def's body does not see */
    bool in_material;
    int first_token, first_symbol; /* of the statement that is read */
    int cells; /* repetitions with a name */
    bool any_cell; /* a shape is lowered outside its cell: any cell is valid */
    sdfc_token *tokens;
    int token_count, token_capacity;
    int at; /* the token looked at */
    long work;
    int instrs;
    double cost;
    int depth;
    int loop_depth;
    long loop_index[8];
    sdfc_expr *exprs;
    int expr_count, expr_capacity;
    int time_expr; /* -1: not yet needed */
    bool anchored;
    int anchor_expr[3];
    sdfc_shape *shapes;
    int shape_count, shape_capacity;
    sdfc_user *users;
    int user_count, user_capacity;
    sdfc_symbol *symbols;
    int symbol_count, symbol_capacity;
    masu_sdfc_param *params;
    int param_count, param_capacity;
    sdfc_material *materials;
    int material_count, material_capacity;
    sdfc_part *parts;
    int part_count, part_capacity;
    sdfc_group *groups;
    int group_count, group_capacity;
    uint32_t slot_count;
    int flat_parts;          /* the last ones */
    int term_bits;           /* of all parts, behind the bits of the parts */
    int box[2][3];           /* low and high side of the listed parts: expressions, or -1 */
    uint32_t box_slot[2][3]; /* of the changing sides */
    uint32_t *dynamic_slots; /* pairs: slot, expression */
    int dynamic_count, dynamic_capacity;
    sdfc_place *places; /* behind all other slots, from place_base on */
    int place_count, place_capacity;
    uint32_t place_base;
    double *initial; /* slots */
    void *scratch;
    bool *needed;   /* expressions that slots are made of */
    double *values; /* of expressions, while checking */

    double *variables;
    sdfc_text glsl, c, table, warnings;
} sdfc;

/* ---- lex.c ---- */

void sdfc_lex(sdfc *c);

/* ---- message.c ---- */

enum { SDFC_NAMES_SHAPES = 1, SDFC_NAMES_NUMBERS = 2, SDFC_NAMES_MATERIALS = 4 };
void sdfc_report(sdfc *c, uint32_t line, uint32_t column, uint32_t offset, const char *message);
/* Like sdfc_expected, with the most similar name of these kinds. */
SDFC_NORETURN void sdfc_unknown(sdfc *c, int token, unsigned kinds, const char *what);
/* Reports at a token and gives up; "expected WHAT, found THE TOKEN" */
SDFC_NORETURN void sdfc_fail(sdfc *c, int token, const char *format, ...) SDFC_PRINTF(3, 4);
SDFC_NORETURN void sdfc_expected(sdfc *c, int token, const char *format, ...) SDFC_PRINTF(3, 4);
void sdfc_warn(sdfc *c, int token, const char *format, ...) SDFC_PRINTF(3, 4);

void sdfc_put(sdfc *c, sdfc_text *text, const char *format, ...) SDFC_PRINTF(3, 4);
void sdfc_put_bytes(sdfc *c, sdfc_text *text, const char *bytes, size_t length);
/* An array's next element: grows it, at most to `most`. */
void *sdfc_grow(sdfc *c, void *array, int count, int *capacity, size_t size, int most,
                const char *what);
void *sdfc_take(sdfc *c, size_t count, size_t size); /* zeros */

/* ---- expr.c ---- */

int sdfc_number(sdfc *c, double value);
int sdfc_param_expr(sdfc *c, int param);
int sdfc_time_expr(sdfc *c);
int sdfc_anchor_expr(sdfc *c, int axis);              /* 0 but in the GLSL of an anchored scene */
int sdfc_apply(sdfc *c, int op, int x, int y, int z); /* unused operands: 0 */
/* The values of all expressions for these parameters and this time. */
void sdfc_evaluate(const sdfc *c, const double *params, double time, double *values);

#define SDFC_EXPR(c, i) ((c)->exprs[i])
static inline bool sdfc_constant(const sdfc *c, int e) { return c->exprs[e].op == SDFC_CONST; }
static inline bool sdfc_is(const sdfc *c, int e, double value) {
    return c->exprs[e].op == SDFC_CONST && c->exprs[e].value == value;
}

int sdfc_leaf(sdfc *c, int op, int a, int b, double low, double high); /* a local one */
/* The footprint of a pixel in the units of e, 0 if unknown; the remaining amplitude of noise
 * there. */
int sdfc_footprint(sdfc *c, int e);
int sdfc_fade(sdfc *c, const int e[3]);

/* ---- expression.c, define.c ---- */

const char *sdfc_function_name(int i); /* NULL behind the last */
double sdfc_need_constant(sdfc *c, const char *what);
void sdfc_parse_pair(sdfc *c, int out[2]);
void sdfc_parse_def(sdfc *c);
/* Returns the shape, or fills in the value. */
int sdfc_call_def(sdfc *c, int def, int token, sdfc_value *v);
bool sdfc_begins_shape(sdfc *c);
/* p, n, ... in a material description */
bool sdfc_local_name(sdfc *c, int token, sdfc_value *v);
sdfc_value sdfc_parse_cell(sdfc *c, int token, const sdfc_symbol *s); /* .hash(0) */

/* ---- parse.c, shape.c ---- */

/* Rejects masu_param(n) of a block if n is a literal without a parameter. */
void sdfc_check_blocks(sdfc *c);
sdfc_symbol *sdfc_declare(sdfc *c, int token, sdfc_symbol_kind kind);
int sdfc_need_name(sdfc *c, const char *what, bool declared);
int sdfc_need_shape_name(sdfc *c); /* of a shape or def that is declared */
int sdfc_parse_material_name(sdfc *c);

void sdfc_parse(sdfc *c);
void sdfc_enter(sdfc *c); /* one level deeper, or an error */
void sdfc_leave(sdfc *c);
sdfc_value sdfc_parse_expression(sdfc *c);
int sdfc_parse_scalar(sdfc *c);
void sdfc_parse_vector(sdfc *c, int out[3]); /* a number stands for three */
long sdfc_parse_whole(sdfc *c, long low, long high);
bool sdfc_is_mark(const sdfc *c, char mark);
bool sdfc_mark(sdfc *c, char mark); /* takes it if it is there */
void sdfc_need_mark(sdfc *c, char mark);
bool sdfc_word(sdfc *c, const char *word);
bool sdfc_token_is(const sdfc *c, int token, const char *word);
void sdfc_next(sdfc *c);
const sdfc_symbol *sdfc_find(sdfc *c, int token);
int sdfc_parse_shape(sdfc *c);

/* ---- the rest ---- */

void sdfc_analyse(sdfc *c, int shape); /* fills in facts and extra */
void sdfc_lower(sdfc *c, sdfc_part *part);
int sdfc_box_side(sdfc *c, int axis, bool high); /* around the listed parts; -1: endless */
/* Whether the movements around all else in a part change with time. */
bool sdfc_root_moves(const sdfc *c, const sdfc_program *p);
void sdfc_group_parts(sdfc *c);  /* by form, and orders them */
void sdfc_assign_slots(sdfc *c); /* after that */
void sdfc_assign_terms(sdfc *c);                 /* bits, of a scene of few parts */
bool sdfc_any_rough(const sdfc *c); /* fractals, steep fields, and fields with unknown properties */
uint32_t sdfc_term_word(const sdfc *c, int word); /* the bits of terms in it */
/* number of values for all bits, or for positions in a list; 0: no selection */
uint32_t sdfc_block_words(const sdfc *c);
void sdfc_emit(sdfc *c);
void sdfc_check(sdfc *c, uint32_t pairs);
/* Warns of parts that a camera is inside of. */
void sdfc_check_cameras(sdfc *c, const masu_sdfc_camera *cameras, uint32_t count);
void sdfc_start(sdfc *c); /* initialises the fields that do not start at 0 */
void sdfc_free_program(sdfc_program *p); /* frees its contents */
void sdfc_free(sdfc *c);                 /* and all it has taken */
double sdfc_run(const sdfc *c, const sdfc_program *p, const double p3[3], uint64_t *cells);
/* The same with room for the program's variables. */
double sdfc_run_in(const sdfc *c, const sdfc_program *p, const double p3[3], double *room);
typedef struct sdfc_place_of {
    double normal[3], footprint;
} sdfc_place_of;
/* Albedo, roughness, emissive, metallic of a part there. */
void sdfc_run_look(const sdfc *c, const sdfc_part *part, const double p3[3],
                   const sdfc_place_of *at, double *room, double out[8]);
void sdfc_fill_part(const sdfc *c, int i, masu_sdfc_part *out);

#endif
