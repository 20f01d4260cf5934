graph [ directed 1 node [ id 0 label "a&amp;" x 1.5 ] node [ id 7 graphics [ x 1 y 2 ] ] edge [ source 0 target 7 weight 2 ] ]
