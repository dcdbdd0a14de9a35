/* nodes.h: a node of a movable model (models.h): its parent and transform. */
#ifndef MASU_NODES_H
#define MASU_NODES_H

#include <stdint.h>

/* Nodes of one model are contiguous, each after its parent. */
typedef struct masu_node {
    float local[12]; /* to the node above; of the first ones to the model */
    float world[12];
    uint64_t name;     /* FNV-1a 64, 0: none */
    uint32_t parent;   /* of all nodes, or MASU_BLOB_NONE */
    uint32_t instance; /* or MASU_BLOB_NONE */
} masu_node;

#endif
