/*
 * terms.glsl: selects the terms of the SDF: which are evaluated, and which can affect the field in
 * a ball.
 *
 * Bits (MASU_SDF_BLOCK_WORDS uints) select the parts to evaluate and their terms: operands of
 * unions, cuts and blends. An evaluation with masu_margin set to twice the radius of a ball around
 * the point leaves in masu_kept the bits of all terms that can decide anywhere in the ball: with
 * only these the field has the bit-identical value there. In a ball of radius r the difference of
 * two fields of Lipschitz constant L changes by at most 2 r L from the centre, so min(a, b) is a
 * where b is more than that above it, or k more for a blend of radius k (Barbier et al., "Lipschitz
 * Pruning: Hierarchical Simplification of Primitive-Based SDFs", Computer Graphics Forum 44-2,
 * 2025). Both fields are evaluated anyway: the selection costs three operations per term.
 *
 * In a scene of many parts the bits index the list of its tile. Includers that do not select terms
 * (neither MASU_SDF_KEEP nor MASU_SDF_ASK is defined) get a field without term bits; those with
 * only MASU_SDF_ASK evaluate by bits that another pass has stored.
 */
#ifndef MASU_TERMS_GLSL
#define MASU_TERMS_GLSL

#ifdef MASU_SDF_KEEP
uint masu_kept[2] = uint[](0u, 0u);
uint masu_kept_terms = 0u;
float masu_margin = 0.0;
#ifndef MASU_CHOOSING /* false, for comparison: always evaluates everything the tile contains */
#define MASU_CHOOSING true
#endif
bool masu_keeping = false; /* else no bits are collected, and masu_margin is 0 */

#define MASU_SDF_MARGIN masu_margin
#define masu_term_bits(word) masu_part_bits(word)

void masu_keep_part(float d, float f, uint word, uint bit)
{
    bool drops = d > f + masu_margin;
    uint own = f > d + masu_margin ? 0u : bit;
    masu_kept[0] = (drops ? 0u : masu_kept[0]) | (word == 0u ? own : 0u);
    masu_kept[1] = (drops ? 0u : masu_kept[1]) | (word == 1u ? own : 0u);
}

vec4 masu_sdf_bounds(uint part);

/* For a part whose field bounds nothing except, outside its sphere, the distance to the sphere
 * times its growth. */
void masu_keep_estimate(float d, uint part, float safe, vec3 p)
{
    vec4 sphere = masu_sdf_bounds(part);
    bool far = sphere.w >= 0.0 && (length(p - sphere.xyz) - sphere.w) * safe > d + masu_margin;
    uint own = far ? 0u : 1u << (part & 31u);
    masu_kept[0] |= (part >> 5) == 0u ? own : 0u;
    masu_kept[1] |= (part >> 5) == 1u ? own : 0u;
}

/* For a union or cut: `e`, the operand of `bit`, against the joined field of the operands
 * `before`. */
uint masu_keep_least(uint kept, float joined, float e, float slack, uint bit, uint before)
{
    kept = joined > e + slack ? kept & ~before : kept;
    return e > joined + slack ? kept : kept | bit;
}

#define MASU_IF_KEEPING(does) if (masu_keeping) { does; }
/* Always: else earlier values take registers during an evaluation that keeps nothing. */
#define MASU_KEEP_NONE masu_kept = uint[](0u, 0u);
#define MASU_KEEP_BEGIN masu_kept_terms = 0u;
#define MASU_KEEP_PART(d, f, word, bit) MASU_IF_KEEPING(masu_keep_part(d, f, word, bit))
#define MASU_KEEP_ESTIMATE(d, part, safe) MASU_IF_KEEPING(masu_keep_estimate(d, part, safe, p))
#define MASU_KEEP_TERMS(word, first) MASU_IF_KEEPING(masu_kept[word] |= masu_kept_terms << (first))
#define MASU_KEEP(bit) MASU_IF_KEEPING(kept |= bit)
#define MASU_KEEP_LEAST(joined, e, lipschitz, blend, bit, before)                                  \
    MASU_IF_KEEPING(kept = masu_keep_least(kept, joined, e,                                        \
                                           masu_margin * (lipschitz) + max(blend, 0.0), bit,       \
                                           before))
#define MASU_KEEP_MOST(joined, e, lipschitz, blend, bit, before)                                   \
    MASU_IF_KEEPING(kept = masu_keep_least(kept, -(joined), -(e),                                  \
                                           masu_margin * (lipschitz) + max(blend, 0.0), bit,       \
                                           before))
#define MASU_KEEP_ALL(all, bits) MASU_IF_KEEPING(kept |= (all) ? bits : 0u)
#define MASU_KEPT MASU_IF_KEEPING(masu_kept_terms |= kept)

#else
#define MASU_SDF_MARGIN 0.0
#ifdef MASU_SDF_ASK
#define masu_term_bits(word) masu_part_bits(word)
#else
#define masu_term_bits(word) 0xFFFFFFFFu
#endif
#define MASU_KEEP_NONE
#define MASU_KEEP_BEGIN
#define MASU_KEEP_PART(d, f, word, bit)
#define MASU_KEEP_ESTIMATE(d, part, safe)
#define MASU_KEEP_TERMS(word, first)
#define MASU_KEEP(bit)
#define MASU_KEEP_LEAST(joined, e, lipschitz, blend, bit, before)
#define MASU_KEEP_MOST(joined, e, lipschitz, blend, bit, before)
#define MASU_KEEP_ALL(all, bits)
#define MASU_KEPT
#endif

/* For hand-written fields: one part, whose bit is 0, and terms 1..31. */
#ifdef MASU_SDF_KEEP
uint masu_terms_kept = 0u;

void masu_terms_begin()
{
    masu_terms_kept = 1u;
}

void masu_terms_end()
{
    masu_kept = uint[](masu_terms_kept, 0u);
}

void masu_term_joined(int term, uint before, float joined, float e, float blend)
{
    if (masu_keeping)
        masu_terms_kept = masu_keep_least(masu_terms_kept, joined, e, masu_margin + max(blend, 0.0),
                                          1u << term, before);
}
#else
void masu_terms_begin()
{
}

void masu_terms_end()
{
}

void masu_term_joined(int term, uint before, float joined, float e, float blend)
{
}
#endif

/* Whether a field that is at least `low` everywhere can affect the result next to d. */
bool masu_may_be_below(float low, float d)
{
    return low < d + MASU_SDF_MARGIN;
}

/* Whether a term is selected. */
bool masu_term(int term)
{
    return (masu_term_bits(0) & 1u << term) != 0u;
}

/* The bits of `count` terms, starting with `term`. */
uint masu_terms_from(int term, int count)
{
    return ((1u << count) - 1u) << term;
}

#endif
