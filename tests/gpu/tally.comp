/* tally.comp: a loop with the invocation's number of iterations, for test_model. */
#version 440

layout(local_size_x = 64) in;
layout(set = 0, binding = 1) buffer Values {
    float values[];
};

void main()
{
    uint i = gl_GlobalInvocationID.x;
    float x = values[i];
    for (uint k = 0u; k < i; k++) { /* a comparison, a fused product, a step */
        x = x * 0.5 + 1.0;
    }
    values[i] = x;
}
