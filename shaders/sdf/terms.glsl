/*
 * terms.glsl: what of the field is evaluated, and what of it matters in a ball.
 *
 * Bits (MASU_SDF_BLOCK_WORDS words) say which parts are asked for and which terms of them: operands of unions,
 * cuts and blends. Whoever evaluates the field with masu_margin set to twice the radius of a ball around the point
 * finds in masu_kept the bits of what can decide anywhere in the ball: with these alone the field has the same
 * value there, to the bit. In a ball of radius r two fields of constant L keep their difference within 2 r L of that
 * at the middle, so min(a, b) is a where b is more than that above it, a blend of radius k where it is k more (Barbier et
 * al., "Lipschitz Pruning: Hierarchical Simplification of Primitive-Based SDFs", Computer Graphics Forum 44-2,
 * 2025). Both fields are asked for anyway: what matters costs three operations a term.
 *
 * Of a scene of many parts the bits are of the places in its tile's list. Includers that do not choose terms
 * (neither MASU_SDF_KEEP nor MASU_SDF_ASK is defined) get a field without bits for them; those with MASU_SDF_ASK alone ask by
 * bits that others have kept.
 */
#ifndef MASU_TERMS_GLSL
#define MASU_TERMS_GLSL

#ifdef MASU_SDF_KEEP
uint masu_kept[2] = uint[](0u, 0u);
uint masu_kept_terms = 0u;
float masu_margin = 0.0;
#ifndef MASU_CHOOSING /* false: for comparison, all that the tile sees is asked for always */
#define MASU_CHOOSING true
#endif
bool masu_keeping = false; /* else nothing is kept, and masu_margin is 0 */

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

/* Of a part whose field is no bound of anything but, outside of it, of the distance to its sphere, times its growth. */
void masu_keep_estimate(float d, uint part, float safe, vec3 p)
{
    vec4 sphere = masu_sdf_bounds(part);
    bool far = sphere.w >= 0.0 && (length(p - sphere.xyz) - sphere.w) * safe > d + masu_margin;
    uint own = far ? 0u : 1u << (part & 31u);
    masu_kept[0] |= (part >> 5) == 0u ? own : 0u;
    masu_kept[1] |= (part >> 5) == 1u ? own : 0u;
}

/* Of a join: e, its operand with that bit, against what is joined of those before. */
uint masu_keep_least(uint kept, float joined, float e, float slack, uint bit, uint before)
{
    kept = joined > e + slack ? kept & ~before : kept;
    return e > joined + slack ? kept : kept | bit;
}

#define MASU_IF_KEEPING(does) if (masu_keeping) { does; }
#define MASU_KEEP_NONE MASU_IF_KEEPING(masu_kept = uint[](0u, 0u))
#define MASU_KEEP_BEGIN MASU_IF_KEEPING(masu_kept_terms = 0u)
#define MASU_KEEP_PART(d, f, word, bit) MASU_IF_KEEPING(masu_keep_part(d, f, word, bit))
#define MASU_KEEP_ESTIMATE(d, part, safe) MASU_IF_KEEPING(masu_keep_estimate(d, part, safe, p))
#define MASU_KEEP_TERMS(word, first) MASU_IF_KEEPING(masu_kept[word] |= masu_kept_terms << (first))
#define MASU_KEEP(bit) MASU_IF_KEEPING(kept |= bit)
#define MASU_KEEP_LEAST(joined, e, lipschitz, blend, bit, before) \
    MASU_IF_KEEPING(kept = masu_keep_least(kept, joined, e, masu_margin * (lipschitz) + max(blend, 0.0), bit, before))
#define MASU_KEEP_MOST(joined, e, lipschitz, blend, bit, before) \
    MASU_IF_KEEPING(kept = masu_keep_least(kept, -(joined), -(e), masu_margin * (lipschitz) + max(blend, 0.0), bit, before))
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

/* For fields that are written by hand: one part, whose bit is 0, and terms 1..31. */
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
    if (masu_keeping) masu_terms_kept = masu_keep_least(masu_terms_kept, joined, e, masu_margin + max(blend, 0.0), 1u << term, before);
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

/* Whether what is nowhere below `low` can matter beside d. */
bool masu_may_be_below(float low, float d)
{
    return low < d + MASU_SDF_MARGIN;
}

/* Whether a term is asked for. */
bool masu_term(int term)
{
    return (masu_term_bits(0) & 1u << term) != 0u;
}

/* The bits of `count` terms from that one on. */
uint masu_terms_from(int term, int count)
{
    return ((1u << count) - 1u) << term;
}

#endif
